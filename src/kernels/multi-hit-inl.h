// SPDX-License-Identifier: Apache-2.0
// Several hits of each ray, nearest first.
//
// One traversal, whose bound is the distance of the farthest hit that still counts: C. Gribble,
// "Node Culling Multi-Hit BVH Traversal", Eurographics Symposium on Rendering, Experimental Ideas
// and Implementations, 2016. Against stepping from hit to hit, which J. Amstutz, C. Gribble,
// J. Guenther, I. Wald, "An Evaluation of Multi-Hit Ray Traversal in a BVH using Existing
// First-Hit/ Any-Hit Kernels", Journal of Computer Graphics Techniques 4(4), 2015, compare with it,
// it visits what is near once, and it neither loses nor repeats hits at one distance.
#pragma once

#include "kernels/hit-inl.h"
#include "kernels/hit-list-inl.h"
#include "kernels/kernels-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The answer for an accepted lane.
template <int N>
inline kiwami_hit hit_of(const SceneView& scene, const LeafBlock<N>& leaf, int lane,
                         const Crossings<N>& crossings) {
  kiwami_hit hit;
  hit.t = crossings.t[lane];
  describe_triangle(leaf, lane, crossings, hit);
  const GeometryRange& range = range_of(scene, leaf.id[lane]);
  hit.primitive_id = leaf.id[lane] - range.first_id;
  hit.geometry_id = range.geometry_id;
  hit.instance_id = KIWAMI_INVALID_ID;
  return hit;
}

/// Puts all that the ray meets into a list, for as long as that has room.
template <int N, typename Leaves, typename List, bool kIsOrdered = true>
struct MultiHitQuery : QueryBase<N, Leaves> {
  static constexpr bool kOrdered = kIsOrdered;
  static constexpr bool kShrinks = true;
  using Answer = uint32_t;

  List list;
  bool lacks_room = false;

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    lacks_room =
        this->for_each_hit(leaf, lanes, probe, [&](int lane, const Crossings<N>& crossings) {
          return !list.add(crossings.t[lane],
                           [&] { return hit_of<N>(*this->scene, leaf, lane, crossings); });
        });
    if (list.is_full()) this->best_bound = scaled_upper(*this->ray, list.farthest());
    return lacks_room;
  }

  static uint32_t miss() { return 0; }
  uint32_t answer() const { return static_cast<uint32_t>(list.count); }
};

template <int N, typename Leaves>
using NearestHitsQuery = MultiHitQuery<N, Leaves, NearestHits<kiwami_hit>>;

/// The empty list of a ray, in its slots.
inline NearestHits<kiwami_hit> list_of(const HitLists& lists, size_t ray) {
  return {lists.hits + ray * lists.limit, lists.keys + ray * lists.limit, lists.limit, 0};
}

/// One batch of rays on its way to lists of its nearest hits.
template <int N, typename Leaves>
struct NearestHitsTrace {
  const SceneView& scene;
  const RayBatch& batch;
  const HitLists& lists;

  void trace_singly(size_t first) const {
    NoProbe probe;
    for (size_t i = first; i < batch.count; ++i) {
      const UnalignedRay& ray = ray_of(batch, i);
      if (scene.tree.root.mask() == 0 || !is_traceable(ray)) {
        write_answer(batch, i, NearestHitsQuery<N, Leaves>::miss());
        continue;
      }
      ReadyRay ready;
      set_up(ray, scene.tree, ready);
      NearestHitsQuery<N, Leaves> query;
      query.begin(scene, ready);
      query.list = list_of(lists, i);
      traverse<N>(scene.tree, {scene.tree.root, ready.nearest}, ready, query, probe);
      write_answer(batch, i, query.answer());
    }
  }

  /// Traces the first of the rays that wait, as many as a stream takes, together, also where they
  /// part soon: what ends a single ray early, its nearest hit, does not end these. Most lists are
  /// never full, so children are not visited in order.
  void trace_stream(StreamWaiting<N>& waiting) const {
    using Query = MultiHitQuery<N, Leaves, NearestHits<kiwami_hit>, false>;
    const int size = waiting.count < kStreamSize ? waiting.count : kStreamSize;
    if (size == 0) return;
    Query queries[kStreamSize];
    for (int i = 0; i < size; ++i) {
      queries[i].begin(scene, waiting.rays[i]);
      queries[i].list = list_of(lists, waiting.index[i]);
    }
    StreamSlabs<N> slabs;
    set_up_stream<N>(waiting.rays, size, slabs);
    StreamTraversal<N, Query> traversal{scene.tree, waiting.rays, queries, ~0u >> (32 - size),
                                        slabs};
    traversal.run();
    for (int i = 0; i < size; ++i) write_answer(batch, waiting.index[i], queries[i].answer());
  }

  /// Collects rays by octant from the whole batch.
  void trace_by_octant() const {
    StreamWaiting<N> octants[8];
    size_t first = 0;
    for (; first + N <= batch.count; first += N) {
      set_up_group<NearestHitsQuery<N, Leaves>, N>(
          scene, batch, first,
          [&](uint32_t octant) -> StreamWaiting<N>& { return octants[octant]; });
      for (StreamWaiting<N>& waiting : octants) {
        if (!waiting.is_complete()) continue;
        trace_stream(waiting);
        waiting.shift();
      }
    }
    for (StreamWaiting<N>& waiting : octants) trace_stream(waiting);
    trace_singly(first);
  }
};

/// See NearestHitsKernel.
template <int N, typename Leaves>
void nearest_hits(const SceneView& scene, const RayBatch& batch, const HitLists& lists) {
  const NearestHitsTrace<N, Leaves> trace{scene, batch, lists};
  if (batch.count < kStreamSize || scene.tree.root.mask() == 0) {
    trace.trace_singly(0);
  } else {
    trace.trace_by_octant();
  }
}

/// See ManyHitsKernel.
template <int N, typename Leaves>
size_t many_hits(const SceneView& scene, const RayBatch& batch, const HitRoom& room) {
  const UnalignedRay& ray = ray_of(batch, 0);
  if (scene.tree.root.mask() == 0 || !is_traceable(ray)) return 0;
  ReadyRay ready;
  set_up(ray, scene.tree, ready);
  MultiHitQuery<N, Leaves, CollectedHits> query;
  query.begin(scene, ready);
  query.list.begin(room);
  NoProbe probe;
  traverse<N>(scene.tree, {scene.tree.root, ready.nearest}, ready, query, probe);
  if (query.lacks_room) return room.capacity + 1;
  query.list.settle();
  return query.list.count;
}

template <int N, typename Leaves = StoredLeaves<N>>
MultiHitKernels multi_hit_kernels() {
  return {nearest_hits<N, Leaves>, many_hits<N, Leaves>};
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
