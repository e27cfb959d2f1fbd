// SPDX-License-Identifier: Apache-2.0
// Axis-aligned boxes.
#pragma once

#include <limits>

#include "math/vec3.h"

namespace kiwami {

/// The smaller (larger) of two floats; where one is NaN, the accumulated one stays.
inline float min_keep(float accumulated, float other) {
  return other < accumulated ? other : accumulated;
}
inline float max_keep(float accumulated, float other) {
  return other > accumulated ? other : accumulated;
}

struct Bounds {
  Vec3f lower, upper;

  /// The box of nothing: the identity of extend. Infinite rather than FLT_MAX so that a scene
  /// without triangles reports bounds that no finite number can be mistaken for.
  static Bounds empty() {
    constexpr float infinity = std::numeric_limits<float>::infinity();
    return {{infinity, infinity, infinity}, {-infinity, -infinity, -infinity}};
  }

  void extend(const Vec3f& point) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = min_keep(lower[axis], point[axis]);
      upper[axis] = max_keep(upper[axis], point[axis]);
    }
  }

  void extend(const Bounds& other) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = min_keep(lower[axis], other.lower[axis]);
      upper[axis] = max_keep(upper[axis], other.upper[axis]);
    }
  }

  bool is_empty() const {
    return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z);
  }

  bool contains(const Bounds& inner) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(lower[axis] <= inner.lower[axis] && inner.upper[axis] <= upper[axis])) return false;
    }
    return true;
  }

  /// Half the surface area, the measure that the surface area heuristic compares; 0 when empty.
  /// Coordinates are at most 2^60, so it cannot overflow.
  float half_area() const {
    if (is_empty()) return 0.0f;
    const Vec3f extent = upper - lower;
    return extent.x * extent.y + extent.y * extent.z + extent.z * extent.x;
  }
};

/// What two boxes have in common; empty (see is_empty) where they share no point.
inline Bounds intersection_of(Bounds a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    a.lower[axis] = max_keep(a.lower[axis], b.lower[axis]);
    a.upper[axis] = min_keep(a.upper[axis], b.upper[axis]);
  }
  return a;
}

}  // namespace kiwami
