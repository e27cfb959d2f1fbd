// SPDX-License-Identifier: Apache-2.0
// The kernels of one width: batches of rays, one after the other.
#pragma once

#include "kernels/traversal-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

template <typename Query, int N, typename Probe>
inline typename Query::Answer trace_one(const SceneView& scene, const kiwami_ray& ray,
                                        Probe& probe) {
  if (scene.tree.root_mask == 0 || !is_traceable(ray)) return Query::miss();
  ScalarRay scalar;
  set_up_scalar(ray, scalar);
  SlabRay<N> slabs;
  set_up_slabs<N>(scalar, scene.tree, slabs);
  Query query(scene, scalar);
  traverse<N>(scene.tree, slabs, query, probe);
  return query.answer();
}

/// Rays and answers lie at any address, so they are copied in and out.
template <typename Query, int N, typename Probe>
inline void trace_batch(const SceneView& scene, const RayBatch& batch, Probe& probe) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_ray ray;
    __builtin_memcpy(&ray, batch.rays + i * batch.ray_stride, sizeof ray);
    const typename Query::Answer answer = trace_one<Query, N>(scene, ray, probe);
    __builtin_memcpy(batch.answers + i * batch.answer_stride, &answer, sizeof answer);
  }
}

template <typename Query, int N>
void trace(const SceneView& scene, const RayBatch& batch) {
  NoProbe probe;
  trace_batch<Query, N>(scene, batch, probe);
}

template <typename Query, int N>
void trace_counted(const SceneView& scene, const RayBatch& batch, TraversalCounters& counters) {
  CountingProbe probe{counters};
  trace_batch<Query, N>(scene, batch, probe);
}

template <int N>
inline TraversalKernels kernels_of_width() {
  return {trace<ClosestHitQuery<N>, N>, trace<AnyHitQuery<N>, N>, trace<AllHitsQuery<N>, N>,
          trace_counted<ClosestHitQuery<N>, N>, trace_counted<AnyHitQuery<N>, N>};
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
