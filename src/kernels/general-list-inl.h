// SPDX-License-Identifier: Apache-2.0
// Lists of the nearest hits of a ray in scenes of all kinds. See kernels/multi-hit-inl.h.
#pragma once

#include "kernels/general-query-inl.h"
#include "kernels/hit-list-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The nearest hits beyond one of them. No filter is asked: that is for the caller, who sees them
/// in their order.
template <int N>
struct GeneralNearestHits : GeneralQuery<N> {
  static constexpr bool kOrdered = true;
  static constexpr bool kCounts = false;

  NearestHits<GeneralHit> list;
  const GeneralHit* after;
  float tmax;

  void begin(const QueryOptions& of_ray, const UnalignedRay& given, const GeneralHitList& target) {
    GeneralQuery<N>::begin(of_ray, 0);
    this->asks_filter = false;
    tmax = finite_tmax(given);
    list = {target.hits, target.keys, target.limit, 0};
    after = target.after;
  }

  float reach() const { return list.is_full() ? list.farthest() : tmax; }

  template <typename Describe>
  bool accept(float t, uint32_t geometry_id, uint32_t primitive_id, Describe describe) {
    if (t > reach() || this->is_excluded(geometry_id, primitive_id)) return false;
    GeneralHit found;
    found.hit.t = t;
    found.hit.primitive_id = primitive_id;
    found.hit.geometry_id = geometry_id;
    found.hit.instance_id = this->instance_id();
    found.path = this->path;
    found.is_asked = this->is_opaque ? 0 : 1;
    if (after && (t < after->hit.t || (t == after->hit.t && compare_numbers(found, *after) <= 0))) {
      return false;
    }
    list.add(t, [&] {
      describe(found.hit);
      return found;
    });
    if (list.is_full()) this->best_bound = scaled_upper(*this->ray, list.farthest());
    return false;
  }

  template <typename Probe>
  bool visit_leaf(const LeafBlock<N>& leaf, uint32_t lanes, Probe& probe) {
    return offer_triangles(*this, leaf, lanes, probe);
  }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
