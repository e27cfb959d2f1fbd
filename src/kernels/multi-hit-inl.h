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
#include "kernels/traversal-inl.h"

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
template <int N, typename Leaves, typename List>
struct MultiHitQuery : QueryBase<N, Leaves> {
  static constexpr bool kOrdered = true;

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
};

template <int N, typename Leaves, typename List>
inline size_t trace_lists(const SceneView& scene, const RayBatch& batch, uint32_t max_hits,
                          HitRoom& room) {
  NoProbe probe;
  MultiHitQuery<N, Leaves, List> query;
  for (size_t i = 0; i < batch.count; ++i) {
    const UnalignedRay& ray = ray_of(batch, i);
    room.counts[i] = 0;
    if (scene.tree.root.mask() == 0 || !is_traceable(ray)) continue;
    ReadyRay ready;
    set_up(ray, scene.tree, ready);
    query.begin(scene, ready);
    query.list.begin(max_hits, room);
    traverse<N>(scene.tree, {scene.tree.root, ready.nearest}, ready, query, probe);
    if (query.lacks_room || !query.list.deliver(room, room.counts[i])) return i;
  }
  return batch.count;
}

/// See MultiHitKernel.
template <int N, typename Leaves = StoredLeaves<N>>
size_t multi_hit(const SceneView& scene, const RayBatch& batch, uint32_t max_hits, HitRoom& room) {
  if (max_hits != 0 && max_hits <= NearestHits::kCapacity) {
    return trace_lists<N, Leaves, NearestHits>(scene, batch, max_hits, room);
  }
  return trace_lists<N, Leaves, CollectedHits>(scene, batch, max_hits, room);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
