// SPDX-License-Identifier: Apache-2.0
// The kernels of one width: batches of rays, one after the other or in packets.
#pragma once

#include "kernels/packet-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Rays and answers lie at any address, so they are copied in and out.
inline kiwami_ray read_ray(const RayBatch& batch, size_t i) {
  kiwami_ray ray;
  __builtin_memcpy(&ray, batch.rays + i * batch.ray_stride, sizeof ray);
  return ray;
}
template <typename Answer>
inline void write_answer(const RayBatch& batch, size_t i, const Answer& answer) {
  __builtin_memcpy(batch.answers + i * batch.answer_stride, &answer, sizeof answer);
}

template <typename Query, int N, typename Probe>
inline typename Query::Answer trace_one(const SceneView& scene, const kiwami_ray& ray,
                                        Probe& probe) {
  if (scene.tree.root_mask == 0 || !is_traceable(ray)) return Query::miss();
  ScalarRay scalar;
  set_up_scalar(ray, scalar);
  SlabRay<N> slabs;
  set_up_slabs<N>(scalar, scene.tree, slabs);
  Query query;
  query.begin(scene, scalar);
  const float begin = scaled_lower(scalar, scalar.tmin);
  traverse<N>(scene.tree, {scene.tree.root, scene.tree.root_mask, begin, 0}, slabs, query, probe);
  return query.answer();
}

/// Whether the next rays of a batch may go together: all traceable, and no axis along which some
/// run backward and others forward.
template <int N>
inline bool is_packet(const kiwami_ray* rays) {
  const auto backward = [](const kiwami_ray& ray) {
    return sign_bits(load<4>(second_half(ray))) & 7u;
  };
  const uint32_t first = backward(rays[0]);
  for (int i = 1; i < PacketSlabs<N>::kSize; ++i) {
    if (backward(rays[i]) != first) return false;
  }
  for (int i = 0; i < PacketSlabs<N>::kSize; ++i) {
    if (!is_traceable(rays[i])) return false;
  }
  return true;
}

template <typename Query, int N>
inline void trace_packet(const SceneView& scene, const kiwami_ray* rays, const RayBatch& batch,
                         size_t first) {
  constexpr int size = PacketSlabs<N>::kSize;
  ScalarRay scalars[size];
  Query queries[size];
  for (int i = 0; i < size; ++i) {
    set_up_scalar(rays[i], scalars[i]);
    queries[i].begin(scene, scalars[i]);
  }
  PacketSlabs<N> packet;
  set_up_packet<N>(scalars, scene.tree, packet);
  PacketTraversal<N, Query>{scene.tree, packet, queries}.run();
  for (int i = 0; i < size; ++i) write_answer(batch, first + i, queries[i].answer());
}

template <typename Query, int N>
void trace(const SceneView& scene, const RayBatch& batch) {
  constexpr size_t size = PacketSlabs<N>::kSize;
  NoProbe probe;
  size_t i = 0;
  while (batch.count - i >= size && scene.tree.root_mask != 0) {
    kiwami_ray rays[size];
    for (size_t k = 0; k < size; ++k) rays[k] = read_ray(batch, i + k);
    if (is_packet<N>(rays)) {
      trace_packet<Query, N>(scene, rays, batch, i);
    } else {
      for (size_t k = 0; k < size; ++k) {
        write_answer(batch, i + k, trace_one<Query, N>(scene, rays[k], probe));
      }
    }
    i += size;
  }
  for (; i < batch.count; ++i) {
    write_answer(batch, i, trace_one<Query, N>(scene, read_ray(batch, i), probe));
  }
}

template <typename Query, int N>
void trace_counted(const SceneView& scene, const RayBatch& batch, TraversalCounters& counters) {
  CountingProbe probe{counters};
  for (size_t i = 0; i < batch.count; ++i) {
    write_answer(batch, i, trace_one<Query, N>(scene, read_ray(batch, i), probe));
  }
}

template <int N>
inline TraversalKernels kernels_of_width() {
  return {trace<ClosestHitQuery<N>, N>, trace<AnyHitQuery<N>, N>, trace<AllHitsQuery<N>, N>,
          trace_counted<ClosestHitQuery<N>, N>, trace_counted<AnyHitQuery<N>, N>};
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
