// SPDX-License-Identifier: Apache-2.0
// The queries of the general kernels. They know no instances, either: what the traversal enters is
// their scene and their ray, and the path that leads there is at hand.
#pragma once

#include "kernels/hit-inl.h"
#include "kernels/places-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The numbers of the instances that lead from the traced scene to the current one.
struct InstancePath {
  uint32_t depth;
  uint32_t number[KIWAMI_MAX_INSTANCE_DEPTH];
};

/// By the first number that differs; a path that begins another is less.
inline bool is_less(const InstancePath& a, const InstancePath& b) {
  for (uint32_t i = 0; i < a.depth && i < b.depth; ++i) {
    if (a.number[i] != b.number[i]) return a.number[i] < b.number[i];
  }
  return a.depth < b.depth;
}

inline bool is_equal(const InstancePath& a, const InstancePath& b) {
  if (a.depth != b.depth) return false;
  for (uint32_t i = 0; i < a.depth; ++i) {
    if (a.number[i] != b.number[i]) return false;
  }
  return true;
}

/// Where a hit is, beside its distance.
struct HitPlace {
  const InstancePath& path;
  uint32_t geometry_id, primitive_id;
};

/// The order of hits at the same distance.
inline bool is_before(const HitPlace& a, const HitPlace& b) {
  if (!is_equal(a.path, b.path)) return is_less(a.path, b.path);
  return a.geometry_id != b.geometry_id ? a.geometry_id < b.geometry_id
                                        : a.primitive_id < b.primitive_id;
}

/// What general queries share. The scene and the ray are those of the current level; a distance is
/// the same at each.
template <int N>
struct GeneralQuery : QueryBase<N, AnyLeaves<N>> {
  QueryOptions options;  ///< of this ray
  InstancePath path;

  void begin(const QueryOptions& of_ray, const UnalignedRay&) {
    options = of_ray;
    path.depth = 0;
  }

  /// Goes on in a scene, with the ray as it is there. Nothing beyond reach is of interest.
  void set_level(const SceneView& level_scene, const ReadyRay& level_ray, float reach) {
    this->scene = &level_scene;
    this->ray = &level_ray;
    this->best_bound = scaled_upper(level_ray, reach);
  }

  void deliver() const {}
};

/// The greatest finite distance of interest.
inline float finite_tmax(const UnalignedRay& ray) {
  return ray.tmax < __FLT_MAX__ ? ray.tmax : __FLT_MAX__;
}

/// The least (t, path, geometry, primitive).
template <int N>
struct GeneralClosestHit : GeneralQuery<N> {
  static constexpr bool kOrdered = true;
  using Answer = kiwami_hit;

  kiwami_hit best;
  InstancePath best_path;

  void begin(const QueryOptions& of_ray, const UnalignedRay& given) {
    GeneralQuery<N>::begin(of_ray, given);
    best = ClosestHitQuery<N>::miss();
    best.t = finite_tmax(given);
  }

  float reach() const { return best.t; }
  bool is_found() const { return best.primitive_id != KIWAMI_INVALID_ID; }

  /// Whether a hit is less than what was found so far.
  bool is_nearer(float t, uint32_t geometry_id, uint32_t primitive_id) const {
    if (t != best.t) return t < best.t;
    return !is_found() || is_before({this->path, geometry_id, primitive_id},
                                    {best_path, best.geometry_id, best.primitive_id});
  }

  /// Offers a hit of the current level, of which describe(hit) fills in u, v and the normal.
  /// Returns true where that ends the query.
  template <typename Describe>
  bool accept(float t, uint32_t geometry_id, uint32_t primitive_id, Describe describe) {
    if (!is_nearer(t, geometry_id, primitive_id)) return false;
    best.t = t;
    best.geometry_id = geometry_id;
    best.primitive_id = primitive_id;
    best_path = this->path;
    this->best_bound = scaled_upper(*this->ray, t);
    describe(best);
    return false;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    this->for_each_hit(leaf, lanes, probe, [&](int lane, const Crossings<N>& crossings) {
      const float t = crossings.t[lane];
      if (t > best.t) return false;
      const GeometryRange& range = range_of(*this->scene, leaf.id[lane]);
      return accept(t, range.geometry_id, leaf.id[lane] - range.first_id,
                    [&](kiwami_hit& hit) { describe_triangle(leaf, lane, crossings, hit); });
    });
    return false;
  }

  kiwami_hit answer() const {
    if (!is_found()) return ClosestHitQuery<N>::miss();
    kiwami_hit hit = best;
    hit.instance_id = best_path.depth != 0 ? best_path.number[0] : KIWAMI_INVALID_ID;
    return hit;
  }

  /// Writes what does not stand in the answer.
  void deliver() const {
    if (!this->options.instance_paths) return;
    const uint32_t depth = is_found() ? best_path.depth : 0;
    uint32_t numbers[KIWAMI_MAX_INSTANCE_DEPTH];
    for (uint32_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
      numbers[i] = i < depth ? best_path.number[i] : KIWAMI_INVALID_ID;
    }
    __builtin_memcpy(this->options.instance_paths, numbers, sizeof numbers);
  }
};

/// Whether there is a hit: ends at the first.
template <int N>
struct GeneralAnyHit : GeneralQuery<N> {
  static constexpr bool kOrdered = false;
  using Answer = uint8_t;

  float tmax;
  bool is_hit;

  void begin(const QueryOptions& of_ray, const UnalignedRay& given) {
    GeneralQuery<N>::begin(of_ray, given);
    tmax = finite_tmax(given);
    is_hit = false;
  }

  float reach() const { return tmax; }

  template <typename Describe>
  bool accept(float, uint32_t, uint32_t, Describe) {
    is_hit = true;
    return true;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    is_hit = this->for_each_hit(leaf, lanes, probe, [](int, const Crossings<N>&) { return true; });
    return is_hit;
  }

  uint8_t answer() const { return is_hit ? 1 : 0; }
};

/// How many hits there are.
template <int N>
struct GeneralAllHits : GeneralQuery<N> {
  static constexpr bool kOrdered = false;
  using Answer = uint32_t;

  float tmax;
  uint32_t count;

  void begin(const QueryOptions& of_ray, const UnalignedRay& given) {
    GeneralQuery<N>::begin(of_ray, given);
    tmax = finite_tmax(given);
    count = 0;
  }

  float reach() const { return tmax; }

  template <typename Describe>
  bool accept(float, uint32_t, uint32_t, Describe) {
    ++count;
    return false;
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

  uint32_t answer() const { return count; }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
