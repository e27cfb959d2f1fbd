// SPDX-License-Identifier: Apache-2.0
// The kernels of one width: batches of rays, one after the other or in packets.
#pragma once

#include "kernels/packet-inl.h"
#include "kernels/places-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Rays and answers lie at any address.
inline const UnalignedRay& ray_of(const RayBatch& batch, size_t i) {
  return *reinterpret_cast<const UnalignedRay*>(batch.rays + i * batch.ray_stride);
}
template <typename Answer>
inline void write_answer(const RayBatch& batch, size_t i, const Answer& answer) {
  __builtin_memcpy(batch.answers + i * batch.answer_stride, &answer, sizeof answer);
}
/// Member by member, from registers: a hit that is put together in memory first and then copied by
/// vectors that span two of its stores waits until those have left the store buffer.
inline void write_answer(const RayBatch& batch, size_t i, const kiwami_hit& hit) {
  unsigned char* const target = batch.answers + i * batch.answer_stride;
  const auto put = [&](size_t offset, const auto& member) {
    __builtin_memcpy(target + offset, &member, sizeof member);
  };
  put(offsetof(kiwami_hit, t), hit.t);
  put(offsetof(kiwami_hit, u), hit.u);
  put(offsetof(kiwami_hit, v), hit.v);
  put(offsetof(kiwami_hit, normal_x), hit.normal_x);
  put(offsetof(kiwami_hit, normal_y), hit.normal_y);
  put(offsetof(kiwami_hit, normal_z), hit.normal_z);
  put(offsetof(kiwami_hit, primitive_id), hit.primitive_id);
  put(offsetof(kiwami_hit, geometry_id), hit.geometry_id);
  put(offsetof(kiwami_hit, instance_id), hit.instance_id);
}

/// One ray that is set up, through the whole tree.
template <typename Query, int N, typename Probe>
inline typename Query::Answer trace_set_up(const SceneView& scene, const ScalarRay& scalar,
                                           Probe& probe) {
  SlabRay<N> slabs;
  set_up_slabs<N>(scalar, scene.tree, slabs);
  Query query;
  query.begin(scene, scalar);
  const float begin = scaled_lower(scalar, scalar.tmin);
  traverse<N>(scene.tree, {scene.tree.root, begin}, slabs, query, probe);
  return query.answer();
}

template <typename Query, int N, typename Probe>
inline typename Query::Answer trace_one(const SceneView& scene, const UnalignedRay& ray,
                                        Probe& probe) {
  if (scene.tree.root.mask() == 0 || !is_traceable(ray)) return Query::miss();
  ScalarRay scalar;
  set_up_scalar(ray, scalar);
  return trace_set_up<Query, N>(scene, scalar, probe);
}

/// Rays of one octant that wait until they fill a packet.
template <int N>
struct Waiting {
  static constexpr int kSize = PacketSlabs<N>::kSize;

  int count = 0;
  ScalarRay rays[kSize];
  size_t index[kSize];  ///< of the ray in its batch
};

template <typename Query, int N>
inline void trace_packet(const SceneView& scene, const Waiting<N>& waiting, const RayBatch& batch) {
  constexpr int size = PacketSlabs<N>::kSize;
  Query queries[size];
  for (int i = 0; i < size; ++i) queries[i].begin(scene, waiting.rays[i]);
  PacketSlabs<N> packet;
  set_up_packet<N>(waiting.rays, scene.tree, packet);
  PacketTraversal<N, Query>{scene.tree, packet, queries}.run();
  for (int i = 0; i < size; ++i) write_answer(batch, waiting.index[i], queries[i].answer());
}

/// Traces the rays that wait: together if they fill a packet, alone otherwise.
template <typename Query, int N>
inline void flush(const SceneView& scene, Waiting<N>& waiting, const RayBatch& batch) {
  if (waiting.count == waiting.kSize) {
    trace_packet<Query, N>(scene, waiting, batch);
  } else {
    NoProbe probe;
    for (int i = 0; i < waiting.count; ++i) {
      write_answer(batch, waiting.index[i], trace_set_up<Query, N>(scene, waiting.rays[i], probe));
    }
  }
  waiting.count = 0;
}

/// Traces rays of one octant together. Any-hit rays are collected from the whole batch: they gain
/// even where they are incoherent, since a packet is in no hurry to reach the nearest hit. For the
/// closest hit only rays that follow each other go together: those are likely to be coherent.
template <typename Query, int N>
__attribute__((noinline)) void trace_together(const SceneView& scene, const RayBatch& batch) {
  Waiting<N> octants[8];
  uint32_t last = 0;
  for (size_t i = 0; i < batch.count; ++i) {
    const UnalignedRay& ray = ray_of(batch, i);
    if (!is_traceable(ray)) {
      write_answer(batch, i, Query::miss());
      continue;
    }
    const uint32_t octant = sign_bits(direction_of(ray)) & kAllAxes;
    if (Query::kOrdered && octant != last) flush<Query, N>(scene, octants[last], batch);
    last = octant;
    Waiting<N>& waiting = octants[octant];
    set_up_scalar(ray, waiting.rays[waiting.count]);
    waiting.index[waiting.count] = i;
    if (++waiting.count == waiting.kSize) flush<Query, N>(scene, waiting, batch);
  }
  for (Waiting<N>& waiting : octants) flush<Query, N>(scene, waiting, batch);
}

template <typename Query, int N>
void trace(const SceneView& scene, const RayBatch& batch) {
  if (batch.count >= PacketSlabs<N>::kSize && scene.tree.root.mask() != 0) {
    trace_together<Query, N>(scene, batch);
    return;
  }
  NoProbe probe;
  for (size_t i = 0; i < batch.count; ++i) {
    write_answer(batch, i, trace_one<Query, N>(scene, ray_of(batch, i), probe));
  }
}

template <typename Query, int N>
void trace_counted(const SceneView& scene, const RayBatch& batch, TraversalCounters& counters) {
  CountingProbe<N> probe{counters};
  for (size_t i = 0; i < batch.count; ++i) {
    write_answer(batch, i, trace_one<Query, N>(scene, ray_of(batch, i), probe));
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
