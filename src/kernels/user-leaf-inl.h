// SPDX-License-Identifier: Apache-2.0
// One ray against the user primitives of a leaf block: a call for those of each geometry.
#pragma once

#include "kernels/ray-inl.h"
#include "wide/user_source.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

inline const UserView& view_of(const UserSource& source, uint32_t id) {
  uint32_t low = 0, high = source.view_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (source.views[middle].first_id <= id ? low : high) = middle;
  }
  return source.views[low];
}

/// Whether the ray may meet a side: the front is where the normal points against the ray.
inline bool shows_visible_side(const kiwami_ray& ray, const kiwami_user_hit& hit) {
  if (ray.flags == 0) return true;
  const double facing = (double{hit.normal_x} * double{ray.direction_x} +
                         double{hit.normal_y} * double{ray.direction_y}) +
                        double{hit.normal_z} * double{ray.direction_z};
  const uint32_t side = facing < 0.0 ? KIWAMI_RAY_CULL_FRONT_FACES : KIWAMI_RAY_CULL_BACK_FACES;
  return (ray.flags & side) == 0;
}

/// Calls accept(view, hit) for each hit that the callbacks report between the ray's tmin and tmax,
/// until accept returns true; then returns true. Sets has_failed where a callback fails: its hits
/// do not count.
template <int N, typename Accept>
inline bool visit_user_primitives(const UserSource& source, const IndexBlock<N>& block,
                                  uint32_t lanes, const kiwami_ray& ray, bool& has_failed,
                                  Accept accept) {
  while (lanes != 0) {
    const UserView& view = view_of(source, block.id[__builtin_ctz(lanes)]);
    uint32_t ids[N];
    uint32_t count = 0;
    // The ids of a geometry follow each other, not so the lanes.
    for (uint32_t rest = lanes; rest; rest &= rest - 1) {
      const int lane = __builtin_ctz(rest);
      if (block.id[lane] - view.first_id >= view.count) continue;
      ids[count++] = block.id[lane] - view.first_id;
      lanes ^= 1u << lane;
    }
    if ((view.mask & ray.mask) == 0) continue;
    kiwami_user_hit hits[N * KIWAMI_USER_HITS_PER_PRIMITIVE];
    kiwami_user_intersection intersection;
    intersection.struct_size = sizeof intersection;
    intersection.primitive_count = count;
    intersection.primitive_ids = ids;
    intersection.ray = &ray;
    intersection.geometry_id = view.geometry_id;
    intersection.hit_capacity = count * KIWAMI_USER_HITS_PER_PRIMITIVE;
    intersection.hits = hits;
    intersection.hit_count = intersection.reserved = 0;
    if (view.intersect(view.user, &intersection) < 0 ||
        intersection.hit_count > count * KIWAMI_USER_HITS_PER_PRIMITIVE) {
      has_failed = true;
      continue;
    }
    for (uint32_t i = 0; i < intersection.hit_count; ++i) {
      const kiwami_user_hit& hit = hits[i];
      if (!(ray.tmin <= hit.t && hit.t <= ray.tmax) || !shows_visible_side(ray, hit)) continue;
      if (accept(view, hit)) return true;
    }
  }
  return false;
}

/// Fills in what a hit says of itself.
inline void describe_user_hit(const kiwami_user_hit& found, kiwami_hit& hit) {
  hit.u = found.u;
  hit.v = found.v;
  hit.normal_x = found.normal_x;
  hit.normal_y = found.normal_y;
  hit.normal_z = found.normal_z;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
