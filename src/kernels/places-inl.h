// SPDX-License-Identifier: Apache-2.0
// Where the triangles of a tree that has duplicates stand (spatial splits: a triangle in several
// leaves, in each with the box of a part of it).
//
// Whether a ray hits a triangle, and at which distance, has nothing to do with boxes, so the same
// hit may be found in each leaf of the triangle that the ray visits: also in one whose box the hit
// point is not in. What the traversal rests on (see kernels/ray-inl.h) still holds for one of them:
// the weights of the hit (edge functions of one sign) make a point of the triangle itself, whatever
// the rounding of the sheared vertices; the boxes of the triangle's references together cover all
// its points, since each cut is rounded outwards; so one of them holds this point, and the margin,
// which is derived for any box around the point, lets the ray enter that box and all above it at or
// before the hit's distance, and leave them at or after it.
#pragma once

#include "kernels/traversal-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Looks for the first lane of a triangle in the leaves that a ray is in at one distance. Looks at
/// ids alone, so the layout of the leaves does not matter.
template <int N>
struct PlaceQuery {
  static constexpr bool kOrdered = false;
  struct Room {};

  float best_bound;
  uint32_t id;
  const uint32_t* first_place = nullptr;

  const uint32_t* leaf_at(const TreeView& tree, ChildReference leaf, Room&) const {
    return leaf_ids_at<N>(tree, leaf);
  }

  template <typename Probe>
  bool visit_leaf(const uint32_t* ids, uint32_t lanes, Probe&) {
    for (; lanes; lanes &= lanes - 1) {
      const uint32_t* const place = ids + __builtin_ctz(lanes);
      if (*place == id && (!first_place || place < first_place)) first_place = place;
    }
    return false;
  }
};

/// The interval is a part of every interval in which the hit is found, so a traversal for the hit
/// visits the same leaves and others.
template <int N>
__attribute__((noinline)) PlaceQuery<N> find_place(const SceneView& scene, const ReadyRay& ray,
                                                   uint32_t id, float t) {
  ReadyRay at_hit = ray;
  at_hit.nearest = scaled_lower(ray, t);
  PlaceQuery<N> query{scaled_upper(ray, t), id};
  NoProbe probe;
  traverse<N>(scene.tree, {scene.tree.root, at_hit.nearest}, at_hit, query, probe);
  return query;
}

template <int N>
inline bool is_first_place(const SceneView& scene, const ReadyRay& ray, const LeafBlock<N>& leaf,
                           int lane, float t) {
  return find_place<N>(scene, ray, leaf.id[lane], t).first_place ==
         leaf_ids_of<N>(scene.tree, leaf) + lane;
}

template <int N>
inline void CountingProbe<N>::on_accept(const SceneView& scene, const ReadyRay& ray, uint32_t id,
                                        float t) {
  on_accept(scene.tree.has_duplicates != 0 ? find_place<N>(scene, ray, id, t).first_place != nullptr
                                           : scaled_upper(ray, t) >= leaf_entry,
            t);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
