// SPDX-License-Identifier: Apache-2.0
// What a traversal looks for: the closest hit, any hit, or the number of all hits. Each query says
// what to do with a leaf; the traversal loop is the same for all. kOrdered: near children come
// first; kShrinks: best_bound draws nearer.
#pragma once

#include "kernels/leaf-inl.h"
#include "kernels/triangle-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

inline const GeometryRange& range_of(const SceneView& scene, uint32_t id) {
  uint32_t low = 0, high = scene.range_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (scene.ranges[middle].first_id <= id ? low : high) = middle;
  }
  return scene.ranges[low];
}

/// Whether the ray may meet the triangle at all, by masks and by the side that it shows. A positive
/// determinant is a triangle seen from its front.
inline bool is_visible(const SceneView& scene, const ReadyRay& ray, uint32_t id,
                       double determinant) {
  if (ray.flags != 0) {
    const uint32_t side =
        __builtin_signbit(determinant) ? KIWAMI_RAY_CULL_BACK_FACES : KIWAMI_RAY_CULL_FRONT_FACES;
    if (ray.flags & side) return false;
  }
  return scene.has_masks == 0 || (range_of(scene, id).mask & ray.mask) != 0;
}

/// The state that all queries share: the ray, and how far along it anything is of interest. Leaves
/// says how leaves become blocks of triangles (see kernels/leaf-inl.h).
template <int N, typename LeavesOfTree = StoredLeaves<N>>
struct QueryBase {
  using Leaves = LeavesOfTree;
  using Room = typename Leaves::Room;

  const SceneView* scene;
  const ReadyRay* ray;
  float best_bound;  ///< scaled and widened; the closest hit draws it nearer

  void begin(const SceneView& scene_view, const ReadyRay& ready) {
    scene = &scene_view;
    ray = &ready;
    best_bound = ready.farthest;
  }

  /// The triangles of a leaf; what is gathered is put into the room.
  const LeafBlock<N>& leaf_at(const TreeView& tree, ChildReference leaf, Room& room) const {
    return Leaves::triangles_of(*scene, tree, leaf, room);
  }

  /// Calls accept(lane, crossings) for each visible triangle of the lanes that the ray meets
  /// between tmin and tmax, until accept returns true; then returns true.
  template <typename Probe, typename Accept>
  bool for_each_hit(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe, Accept accept) {
    ShearedBlock<N> sheared;
    uint32_t inside = test_inside<N>(leaf, *ray, broadcast<N>(ray->nearest),
                                     broadcast<N>(best_bound), lanes, sheared, probe);
    if (inside == 0) return false;
    Crossings<N> crossings;
    for (; inside; inside &= inside - 1) {
      const int lane = __builtin_ctz(inside);
      compute_crossing<N>(sheared, *ray, lane, crossings);
      const float t = crossings.t[lane];
      if (!(ray->tmin <= t && t <= ray->tmax)) continue;
      if (!is_visible(*scene, *ray, leaf.id[lane], crossings.sum[lane])) continue;
      probe.on_accept(*scene, *ray, leaf.id[lane], t);
      if (accept(lane, crossings)) return true;
    }
    return false;
  }
};

/// The least (t, id).
template <int N, typename Leaves = StoredLeaves<N>>
struct ClosestHitQuery : QueryBase<N, Leaves> {
  static constexpr bool kOrdered = true;
  static constexpr bool kShrinks = true;
  using Answer = kiwami_hit;

  float best_t;
  uint32_t best_id;
  const LeafBlock<N>* best_leaf;  ///< nullptr: none; else only of use to Leaves::corners_of
  int best_lane;
  double best_v, best_w, best_sum;  ///< its edge functions

  void begin(const SceneView& scene_view, const ReadyRay& ready) {
    QueryBase<N, Leaves>::begin(scene_view, ready);
    best_t = ready.tmax;
    best_id = KIWAMI_INVALID_ID;
    best_leaf = nullptr;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    bool is_nearer = false;
    this->for_each_hit(leaf, lanes, probe, [&](int lane, const Crossings<N>& crossings) {
      const float t = crossings.t[lane];
      if (t < best_t || (t == best_t && leaf.id[lane] < best_id)) {
        best_t = t;
        best_id = leaf.id[lane];
        best_leaf = &leaf;
        best_lane = lane;
        best_v = crossings.v[lane];
        best_w = crossings.w[lane];
        best_sum = crossings.sum[lane];
        is_nearer = true;
      }
      return false;
    });
    if (is_nearer) this->best_bound = scaled_upper(*this->ray, best_t);
    return false;
  }

  static kiwami_hit miss() {
    kiwami_hit hit;
    hit.t = __builtin_inff();
    hit.u = hit.v = hit.normal_x = hit.normal_y = hit.normal_z = 0.0f;
    hit.primitive_id = hit.geometry_id = hit.instance_id = KIWAMI_INVALID_ID;
    return hit;
  }

  kiwami_hit answer() const {
    if (!best_leaf) return miss();
    kiwami_hit hit;
    hit.t = best_t;
    hit.u = static_cast<float>(best_v / best_sum);
    hit.v = static_cast<float>(best_w / best_sum);
    const auto corner = Leaves::corners_of(*this->scene, best_leaf, best_lane, best_id);
    const auto edge = [&](int k, int axis) { return corner(k, axis) - corner(0, axis); };
    hit.normal_x = edge(1, 1) * edge(2, 2) - edge(1, 2) * edge(2, 1);
    hit.normal_y = edge(1, 2) * edge(2, 0) - edge(1, 0) * edge(2, 2);
    hit.normal_z = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
    const GeometryRange& range = range_of(*this->scene, best_id);
    hit.primitive_id = best_id - range.first_id;
    hit.geometry_id = range.geometry_id;
    hit.instance_id = KIWAMI_INVALID_ID;
    return hit;
  }
};

/// Whether there is a hit: ends at the first.
template <int N, typename Leaves = StoredLeaves<N>>
struct AnyHitQuery : QueryBase<N, Leaves> {
  static constexpr bool kOrdered = false;
  static constexpr bool kShrinks = false;
  using Answer = uint8_t;

  bool is_hit;

  void begin(const SceneView& scene_view, const ReadyRay& ready) {
    QueryBase<N, Leaves>::begin(scene_view, ready);
    is_hit = false;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    is_hit = this->for_each_hit(leaf, lanes, probe, [](int, const Crossings<N>&) { return true; });
    return is_hit;
  }

  static uint8_t miss() { return 0; }
  uint8_t answer() const { return is_hit ? 1 : 0; }
};

/// Of a tree that has duplicates: whether the lane is the first, in memory, of those lanes of its
/// triangle whose leaves the ray is in at the distance t. Every traversal that finds the hit visits
/// all of these.
template <int N>
bool is_first_place(const SceneView& scene, const ReadyRay& ray, const LeafBlock<N>& leaf, int lane,
                    float t);

/// How many triangles the ray meets between tmin and tmax.
template <int N, typename Leaves = StoredLeaves<N>>
struct AllHitsQuery : QueryBase<N, Leaves> {
  static constexpr bool kOrdered = false;
  static constexpr bool kShrinks = false;
  using Answer = uint32_t;

  uint32_t count;

  void begin(const SceneView& scene_view, const ReadyRay& ready) {
    QueryBase<N, Leaves>::begin(scene_view, ready);
    count = 0;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    this->for_each_hit(leaf, lanes, probe, [&](int lane, const Crossings<N>& crossings) {
      const SceneView& view = *this->scene;
      if (view.tree.has_duplicates == 0 ||
          is_first_place(view, *this->ray, leaf, lane, crossings.t[lane])) {
        ++count;
      }
      return false;
    });
    return false;
  }

  static uint32_t miss() { return 0; }
  uint32_t answer() const { return count; }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
