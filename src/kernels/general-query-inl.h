// SPDX-License-Identifier: Apache-2.0
// The queries of the general kernels. They know no instances, either: what the traversal enters is
// their scene and their ray, and the path that leads there is at hand.
#pragma once

#include "kernels/hit-inl.h"
#include "kernels/opacity-inl.h"
#include "kernels/path-inl.h"
#include "kernels/places-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

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

/// What becomes of a hit.
enum class Verdict { kReject, kAccept, kStop };

/// What general queries share. The scene and the ray are those of the current level; a distance is
/// the same at each.
template <int N>
struct GeneralQuery : QueryBase<N, AnyLeaves<N>> {
  const QueryOptions* options;
  size_t index;  ///< of this ray among those that the options are for
  InstancePath path;
  kiwami_exclusion excluded;
  bool has_filter;
  bool asks_filter;  ///< false where the filter is left to the caller
  bool is_opaque;    ///< what is offered, so that no filter is asked

  void begin(const QueryOptions& of_rays, size_t i) {
    options = &of_rays;
    index = i;
    path.depth = 0;
    has_filter = asks_filter = of_rays.filter != nullptr;
    is_opaque = false;
    excluded.primitive_id = KIWAMI_INVALID_ID;
    if (of_rays.exclusions) {
      __builtin_memcpy(&excluded, of_rays.exclusions + i * of_rays.exclusion_stride,
                       sizeof excluded);
    }
  }

  /// Goes on in a scene, with the ray as it is there. Nothing beyond reach is of interest.
  void set_level(const SceneView& level_scene, const ReadyRay& level_ray, float reach) {
    this->scene = &level_scene;
    this->ray = &level_ray;
    this->best_bound = scaled_upper(level_ray, reach);
  }

  /// The number of the outermost instance.
  uint32_t instance_id() const { return path.depth != 0 ? path.number[0] : KIWAMI_INVALID_ID; }

  /// Whether the ray is not to meet this.
  bool is_excluded(uint32_t geometry_id, uint32_t primitive_id) const {
    if (primitive_id != excluded.primitive_id || geometry_id != excluded.geometry_id ||
        primitive_id == KIWAMI_INVALID_ID) {
      return false;
    }
    if (!options->exclusion_paths) return instance_id() == excluded.instance_id;
    uint32_t numbers[KIWAMI_MAX_INSTANCE_DEPTH];
    __builtin_memcpy(numbers, options->exclusion_paths + index * options->exclusion_path_stride,
                     sizeof numbers);
    for (uint32_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
      if (numbers[i] != (i < path.depth ? path.number[i] : KIWAMI_INVALID_ID)) return false;
    }
    return true;
  }

  /// Has the filter judge a hit, of which describe(hit) fills in u, v and the normal. All is
  /// accepted where there is no filter.
  template <typename Describe>
  Verdict ask_filter(float t, uint32_t geometry_id, uint32_t primitive_id, Describe describe) {
    if (!asks_filter || is_opaque) return Verdict::kAccept;
    kiwami_filter_candidate candidate;
    candidate.struct_size = sizeof candidate;
    candidate.depth = path.depth;
    candidate.ray = options->first_ray + index;
    candidate.hit.t = t;
    candidate.hit.primitive_id = primitive_id;
    candidate.hit.geometry_id = geometry_id;
    candidate.hit.instance_id = instance_id();
    candidate.reserved = 0;
    describe(candidate.hit);
    for (uint32_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
      candidate.instance_path[i] = i < path.depth ? path.number[i] : KIWAMI_INVALID_ID;
    }
    switch (options->filter(options->filter_user, &candidate)) {
      case KIWAMI_FILTER_REJECT:
        return Verdict::kReject;
      case KIWAMI_FILTER_ACCEPT:
        return Verdict::kAccept;
      case KIWAMI_FILTER_ACCEPT_AND_STOP:
        return Verdict::kStop;
      default:
        options->report_failed_callback();
        return Verdict::kStop;
    }
  }

  void deliver() const {}
};

/// The greatest finite distance of interest.
inline float finite_tmax(const UnalignedRay& ray) {
  return ray.tmax < __FLT_MAX__ ? ray.tmax : __FLT_MAX__;
}

/// What the micromap says of a hit on a triangle of a scene that has some. Returns false where it
/// is none; sets is_opaque where no filter is to be asked.
template <int N>
inline bool is_met(const SceneView& scene, const GeometryRange& range, const LeafBlock<N>& leaf,
                   int lane, const Crossings<N>& crossings, bool has_filter, bool& is_opaque) {
  const OpacityView& view = scene.opacities[&range - scene.ranges];
  if (view.bits == 0) return true;
  const auto u = static_cast<float>(crossings.v[lane] / crossings.sum[lane]);
  const auto v = static_cast<float>(crossings.w[lane] / crossings.sum[lane]);
  const uint32_t state = opacity_at(view, leaf.id[lane] - range.first_id, u, v);
  is_opaque = state == KIWAMI_OPACITY_OPAQUE;
  if (state == KIWAMI_OPACITY_UNKNOWN_TRANSPARENT) return has_filter;
  return state != KIWAMI_OPACITY_TRANSPARENT;
}

/// Offers a query the triangles that the ray meets in a leaf. Returns true where that ends it.
template <typename Query, int N, typename Probe>
inline bool offer_triangles(Query& query, const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
  return query.for_each_hit(leaf, lanes, probe, [&](int lane, const Crossings<N>& crossings) {
    const float t = crossings.t[lane];
    if (t > query.reach()) return false;
    const SceneView& scene = *query.scene;
    const GeometryRange& range = range_of(scene, leaf.id[lane]);
    bool is_opaque = false;
    if (scene.opacities &&
        !is_met(scene, range, leaf, lane, crossings, query.has_filter, is_opaque)) {
      return false;
    }
    // What is counted, and what a filter is asked about, comes once.
    if ((Query::kCounts || (query.asks_filter && !is_opaque)) && scene.tree.has_duplicates != 0 &&
        !is_first_place(scene, *query.ray, leaf, lane, t)) {
      return false;
    }
    query.is_opaque = is_opaque;
    const bool is_done =
        query.accept(t, range.geometry_id, leaf.id[lane] - range.first_id,
                     [&](kiwami_hit& hit) { describe_triangle(leaf, lane, crossings, hit); });
    query.is_opaque = false;
    return is_done;
  });
}

/// The least (t, path, geometry, primitive).
template <int N>
struct GeneralClosestHit : GeneralQuery<N> {
  static constexpr bool kOrdered = true;
  static constexpr bool kCounts = false;
  using Answer = kiwami_hit;

  kiwami_hit best;
  InstancePath best_path;

  void begin(const QueryOptions& of_rays, size_t i, const UnalignedRay& given) {
    GeneralQuery<N>::begin(of_rays, i);
    best.t = finite_tmax(given);
    best.primitive_id = KIWAMI_INVALID_ID;
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
    if (this->is_excluded(geometry_id, primitive_id)) return false;
    const Verdict verdict = this->ask_filter(t, geometry_id, primitive_id, describe);
    if (verdict == Verdict::kReject) return false;
    best.t = t;
    best.geometry_id = geometry_id;
    best.primitive_id = primitive_id;
    copy_path(this->path, best_path);
    this->best_bound = scaled_upper(*this->ray, t);
    describe(best);
    return verdict == Verdict::kStop;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    return offer_triangles(*this, leaf, lanes, probe);
  }

  kiwami_hit answer() const {
    if (!is_found()) return ClosestHitQuery<N>::miss();
    kiwami_hit hit = best;
    hit.instance_id = best_path.depth != 0 ? best_path.number[0] : KIWAMI_INVALID_ID;
    return hit;
  }

  /// Writes what does not stand in the answer.
  void deliver() const {
    const QueryOptions& asked = *this->options;
    if (!asked.instance_paths) return;
    const uint32_t depth = is_found() ? best_path.depth : 0;
    uint32_t numbers[KIWAMI_MAX_INSTANCE_DEPTH];
    for (uint32_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
      numbers[i] = i < depth ? best_path.number[i] : KIWAMI_INVALID_ID;
    }
    __builtin_memcpy(asked.instance_paths + this->index * asked.instance_path_stride, numbers,
                     sizeof numbers);
  }
};

/// Queries of the whole ray.
template <int N>
struct GeneralWholeRay : GeneralQuery<N> {
  static constexpr bool kOrdered = false;

  float tmax;

  void begin(const QueryOptions& of_rays, size_t i, const UnalignedRay& given) {
    GeneralQuery<N>::begin(of_rays, i);
    tmax = finite_tmax(given);
  }

  float reach() const { return tmax; }
};

/// Whether there is a hit: ends at the first.
template <int N>
struct GeneralAnyHit : GeneralWholeRay<N> {
  static constexpr bool kCounts = false;
  using Answer = uint8_t;

  bool is_hit;

  void begin(const QueryOptions& of_rays, size_t i, const UnalignedRay& given) {
    GeneralWholeRay<N>::begin(of_rays, i, given);
    is_hit = false;
  }

  template <typename Describe>
  bool accept(float t, uint32_t geometry_id, uint32_t primitive_id, Describe describe) {
    if (this->is_excluded(geometry_id, primitive_id)) return false;
    is_hit = this->ask_filter(t, geometry_id, primitive_id, describe) != Verdict::kReject;
    return is_hit;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    return offer_triangles(*this, leaf, lanes, probe);
  }

  uint8_t answer() const { return is_hit ? 1 : 0; }
};

/// How many hits there are.
template <int N>
struct GeneralAllHits : GeneralWholeRay<N> {
  static constexpr bool kCounts = true;
  using Answer = uint32_t;

  uint32_t count;

  void begin(const QueryOptions& of_rays, size_t i, const UnalignedRay& given) {
    GeneralWholeRay<N>::begin(of_rays, i, given);
    count = 0;
  }

  template <typename Describe>
  bool accept(float t, uint32_t geometry_id, uint32_t primitive_id, Describe describe) {
    if (this->is_excluded(geometry_id, primitive_id)) return false;
    const Verdict verdict = this->ask_filter(t, geometry_id, primitive_id, describe);
    if (verdict != Verdict::kReject) ++count;
    return verdict == Verdict::kStop;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    return offer_triangles(*this, leaf, lanes, probe);
  }

  uint32_t answer() const { return count; }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
