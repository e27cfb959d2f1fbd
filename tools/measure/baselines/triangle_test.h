// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>

#include "measure/baselines/triangle_list.h"

namespace kiwami::tools {

/// What a baseline finds: the distance, the barycentric coordinates and the triangle's number.
struct BaselineHit {
  float t;
  float u;
  float v;
  uint32_t triangle;  ///< KIWAMI_INVALID_ID for a miss
};

inline BaselineHit no_hit(const kiwami_ray& ray) {
  return {ray.tmax, 0.0f, 0.0f, KIWAMI_INVALID_ID};
}

/// A triangle ready for the usual test (T. Moeller, B. Trumbore, "Fast, Minimum Storage
/// Ray/Triangle Intersection", Journal of Graphics Tools, 1997), its normal computed once. Fast,
/// and not watertight.
struct PreparedTriangle {
  Vec3 corner;
  Vec3 edge1;
  Vec3 edge2;
  Vec3 normal;
  uint32_t number;

  PreparedTriangle(const Corners& corners, uint32_t its_number)
      : corner(corners[0]),
        edge1(corners[1] - corners[0]),
        edge2(corners[2] - corners[0]),
        normal(cross(edge1, edge2)),
        number(its_number) {}

  /// Whether the ray meets it between tmin and hit.t, which becomes the distance.
  bool intersect(Vec3 origin, Vec3 direction, float tmin, BaselineHit& hit) const {
    const float inverse = -1.0f / dot(direction, normal);
    const Vec3 offset = origin - corner;
    const Vec3 moment = cross(offset, direction);
    const float u = dot(edge2, moment) * inverse;
    const float v = -dot(edge1, moment) * inverse;
    // Written so that NaN, which a triangle along the ray gives, is refused.
    if (!(u >= 0.0f) || !(v >= 0.0f) || !(u + v <= 1.0f)) return false;
    const float t = dot(offset, normal) * inverse;
    if (!(t >= tmin) || !(t <= hit.t)) return false;
    hit = {t, u, v, number};
    return true;
  }
};

}  // namespace kiwami::tools
