// SPDX-License-Identifier: Apache-2.0
// The kernels of one width: batches of rays, one after the other or together.
#pragma once

#include "kernels/answers-inl.h"
#include "kernels/interleaved-inl.h"
#include "kernels/places-inl.h"
#include "kernels/ray-group-inl.h"
#include "kernels/stream-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Answers ray i of a batch, which is set up, by the whole tree.
// Out of line, so that its loop has registers of its own; and what it finds is written where it
// belongs, since an answer that is returned is put together in memory and copied from there.
template <typename Query, int N, typename Probe>
__attribute__((noinline)) void trace_ready(const SceneView& scene, const ReadyRay& ray,
                                           const RayBatch& batch, size_t i, Probe& probe) {
  Query query;
  query.begin(scene, ray);
  traverse_inlined<N>(scene.tree, {scene.tree.root, ray.nearest}, ray, query, probe);
  write_answer(batch, i, query.answer());
}

template <typename Query, int N, typename Probe>
inline void trace_one(const SceneView& scene, const RayBatch& batch, size_t i, Probe& probe) {
  const UnalignedRay& ray = ray_of(batch, i);
  if (scene.tree.root.mask() == 0 || !is_traceable(ray)) {
    write_answer(batch, i, Query::miss());
    return;
  }
  ReadyRay ready;
  set_up(ray, scene.tree, ready);
  trace_ready<Query, N>(scene, ready, batch, i, probe);
}

/// Rays that are set up and wait until kSize of them are traced together, and where they stand in
/// their batch. There is room for the rest of the group of N that completes them.
template <int N, int kSize>
struct Waiting {
  int count = 0;
  ReadyRay rays[kSize + N - 1];
  size_t index[kSize + N - 1];

  bool is_complete() const { return count >= kSize; }

  /// Takes away the first kSize.
  void shift() {
    count -= kSize;
    for (int i = 0; i < count; ++i) {
      rays[i] = rays[kSize + i];
      index[i] = index[kSize + i];
    }
  }
};

/// Sets up the N rays from first on, each in turn in the place that waiting_of(octant) has for it.
/// Those that can only miss are answered.
template <typename Query, int N, typename WaitingOf>
inline void set_up_group(const SceneView& scene, const RayBatch& batch, size_t first,
                         WaitingOf waiting_of) {
  RayGroup<N> group;
  read_group<N>(batch.rays + first * batch.ray_stride, batch.ray_stride, group);
  vfloat<N> scale;
  judge_and_scale<N>(group, scale);
  uint32_t signs[3];
  for (int axis = 0; axis < 3; ++axis) signs[axis] = sign_bits(group.direction[axis]);
  ReadyRay unused;
  ReadyRay* places[N];
  uint8_t backward[N];
  for (int lane = 0; lane < N; ++lane) {
    const size_t i = first + static_cast<size_t>(lane);
    const auto sign = [&](int axis) { return ((signs[axis] >> lane) & 1u) << axis; };
    backward[lane] = static_cast<uint8_t>(sign(0) | sign(1) | sign(2));
    if (((group.traceable >> lane) & 1u) == 0 || ray_of(batch, i).mask == 0) {
      group.unusual &= ~(1u << lane);
      places[lane] = &unused;
      write_answer(batch, i, Query::miss());
      continue;
    }
    auto& waiting = waiting_of(backward[lane]);
    waiting.index[waiting.count] = i;
    places[lane] = &waiting.rays[waiting.count++];
  }
  write_group<N>(batch, first, scene.tree, group, scale, backward, places);
}

template <int N>
using StreamWaiting = Waiting<N, kStreamSize>;

/// Whether closest-hit rays go in streams, by what streams have shown: where their rays part soon,
/// each finds its nearest hit quicker alone. Now and then a stream tries again.
struct StreamChoice {
  /// Rays that visit a node together on average, at which a stream is as quick as single rays.
  static constexpr uint32_t kLeastTogether = 3;
  /// Streams that go alone before one tries again.
  static constexpr int kPause = 15;

  int pause = 0;

  bool take_stream() { return pause == 0 || --pause == 0; }
  void learn(uint32_t visits, uint32_t ray_visits) {
    if (ray_visits < kLeastTogether * visits) pause = kPause + 1;
  }
};

/// Traces the first of the rays that wait, as many as a stream takes, together.
template <typename Query, int N>
inline void trace_stream(const SceneView& scene, StreamWaiting<N>& waiting, const RayBatch& batch,
                         StreamChoice& choice) {
  const int size = waiting.count < kStreamSize ? waiting.count : kStreamSize;
  Query queries[kStreamSize];
  for (int i = 0; i < size; ++i) queries[i].begin(scene, waiting.rays[i]);
  StreamSlabs<N> slabs;
  set_up_stream<N>(waiting.rays, size, slabs);
  StreamTraversal<N, Query> traversal{scene.tree, waiting.rays, queries, ~0u >> (32 - size), slabs};
  traversal.run();
  if constexpr (Query::kOrdered) choice.learn(traversal.visits, traversal.ray_visits);
  for (int i = 0; i < size; ++i) write_answer(batch, waiting.index[i], queries[i].answer());
}

/// The same, one by one.
template <typename Query, int N>
inline void trace_alone(const SceneView& scene, const StreamWaiting<N>& waiting,
                        const RayBatch& batch) {
  const int size = waiting.count < kStreamSize ? waiting.count : kStreamSize;
  if (Query::Leaves::bytes_of(scene) >= kLeastInterleavedBytes) {
    trace_interleaved<Query, N>(scene, waiting.rays, size, [&](int i, const Query& query) {
      write_answer(batch, waiting.index[i], query.answer());
    });
    return;
  }
  NoProbe probe;
  for (int i = 0; i < size; ++i) {
    trace_ready<Query, N>(scene, waiting.rays[i], batch, waiting.index[i], probe);
  }
}

/// Traces the rays from first on one by one.
// Out of line, so that a call of one ray does not save the registers that streams need.
template <typename Query, int N>
__attribute__((noinline)) void trace_singly(const SceneView& scene, const RayBatch& batch,
                                            size_t first) {
  NoProbe probe;
  for (size_t i = first; i < batch.count; ++i) {
    trace_one<Query, N>(scene, batch, i, probe);
  }
}

/// Collects rays by octant from the whole batch.
template <typename Query, int N>
__attribute__((noinline)) void trace_by_octant(const SceneView& scene, const RayBatch& batch) {
  StreamWaiting<N> octants[8];
  StreamChoice choice;
  const auto trace_first = [&](StreamWaiting<N>& waiting) {
    if (waiting.count == 0) return;
    if (choice.take_stream()) {
      trace_stream<Query, N>(scene, waiting, batch, choice);
    } else {
      trace_alone<Query, N>(scene, waiting, batch);
    }
  };
  size_t first = 0;
  for (; first + N <= batch.count; first += N) {
    set_up_group<Query, N>(scene, batch, first,
                           [&](uint32_t octant) -> StreamWaiting<N>& { return octants[octant]; });
    for (StreamWaiting<N>& waiting : octants) {
      if (!waiting.is_complete()) continue;
      trace_first(waiting);
      waiting.shift();
    }
  }
  for (StreamWaiting<N>& waiting : octants) trace_first(waiting);
  trace_singly<Query, N>(scene, batch, first);
}

template <typename Query, int N>
void trace(const SceneView& scene, const RayBatch& batch) {
  if (batch.count < kStreamSize || scene.tree.root.mask() == 0) {
    trace_singly<Query, N>(scene, batch, 0);
  } else {
    trace_by_octant<Query, N>(scene, batch);
  }
}

template <typename Query, int N>
void trace_counted(const SceneView& scene, const RayBatch& batch, TraversalCounters& counters) {
  CountingProbe<N> probe{counters};
  for (size_t i = 0; i < batch.count; ++i) {
    trace_one<Query, N>(scene, batch, i, probe);
  }
}

template <int N, typename Leaves = StoredLeaves<N>>
inline TraversalKernels kernels_of_width() {
  return {trace<ClosestHitQuery<N, Leaves>, N>, trace<AnyHitQuery<N, Leaves>, N>,
          trace<AllHitsQuery<N, Leaves>, N>, trace_counted<ClosestHitQuery<N, Leaves>, N>,
          trace_counted<AnyHitQuery<N, Leaves>, N>};
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
