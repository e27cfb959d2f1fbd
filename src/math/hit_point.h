// SPDX-License-Identifier: Apache-2.0
// The point of a hit on a triangle, its error, and an origin for a ray that leaves the triangle.
//
// After C. Waechter, N. Binder, "A Fast and Robust Method for Avoiding Self-Intersection", Ray
// Tracing Gems, chapter 6, 2019: an origin that is moved along the normal by what rounding may do.
// It departs from the chapter in where the distance comes from: theirs is a number of units in the
// last place that was found by experiment, ours follows from a bound of the library's own triangle
// test, so that no ray meets the triangle again.
//
// The bound. Let u = 2^-24, o the origin, v_k the vertices, X the greatest |v_ka - o_a| of all k
// and axes a. The test (kernels/triangle-inl.h) accepts a triangle at t by weights that are exact
// for the sheared float vertices; the same weights make a point q of the triangle. Sheared
// coordinates take, relative to X: for x and y two roundings of v - o, and four in the product with
// the shear, which is at most 1; for z three; and t one. So along each axis the point o + t d of
// the ray is within (2 + 4 + 3 + 1) u X = 10 u X of q. Let n be the triangle's unit normal on the
// side of d, and e the distance of o from the plane on that side. Then for t >= 0
//   e = n (o - q) <= n (o + t d - q) <= 10 u X |n|_1,
// |n|_1 being the sum of the components' absolute values. An origin at more than 10 u X |n|_1 is
// safe. We take 24: the rest is for products of errors, for the normal's own error (below), and for
// directions that point below the plane: while the point is near the triangle, t |d| < 2 X, so a
// slope of 6 u takes 12 u X.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/rounding.h"
#include "math/vec3.h"

namespace kiwami {

/// In double: within 2^-49 times the greatest coordinate along an axis (13 roundings of at most
/// 2^-53 times it).
struct HitPoint {
  double at[3];
  double uncertainty[3];

  HitPoint(const Vec3f corner[3], float u, float v) {
    for (int axis = 0; axis < 3; ++axis) {
      const double a = corner[0][axis], b = corner[1][axis], c = corner[2][axis];
      at[axis] = a + (u * (b - a) + v * (c - a));
      uncertainty[axis] = 0x1p-49 * std::max({std::abs(a), std::abs(b), std::abs(c)});
    }
  }

  Vec3f rounded() const {
    return {static_cast<float>(at[0]), static_cast<float>(at[1]), static_cast<float>(at[2])};
  }

  /// How far the exact point is from the rounded one, at most.
  Vec3f error() const {
    const Vec3f point = rounded();
    Vec3f error{};
    for (int axis = 0; axis < 3; ++axis) {
      error[axis] =
          round_up(std::abs(static_cast<double>(point[axis]) - at[axis]) + uncertainty[axis]);
    }
    return error;
  }
};

/// A triangle's unit normal; has_side is false where it cannot be told. By the two shorter sides,
/// which is good for needles; each component is off by at most 2^-50 times the product of their
/// lengths, so of one that has_side by 2^-22.
struct TriangleNormal {
  double n[3];
  bool has_side;

  explicit TriangleNormal(const Vec3f corner[3]) {
    double side[3][3], squared[3];  // side k is opposite corner k
    for (int k = 0; k < 3; ++k) {
      squared[k] = 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        side[k][axis] = static_cast<double>(corner[(k + 2) % 3][axis]) -
                        static_cast<double>(corner[(k + 1) % 3][axis]);
        squared[k] += side[k][axis] * side[k][axis];
      }
    }
    const int longest = static_cast<int>(std::max_element(squared, squared + 3) - squared);
    const int i = (longest + 1) % 3, j = (longest + 2) % 3;
    double length = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const int y = (axis + 1) % 3, z = (axis + 2) % 3;
      n[axis] = side[i][y] * side[j][z] - side[i][z] * side[j][y];
      length += n[axis] * n[axis];
    }
    length = std::sqrt(length);
    has_side = length > 0x1p-28 * std::sqrt(squared[i]) * std::sqrt(squared[j]);
    for (double& component : n) component /= length;
  }
};

/// Where a ray to direction starts that leaves the triangle at (u, v).
inline Vec3f offset_origin(const Vec3f corner[3], float u, float v, Vec3f direction) {
  const HitPoint point(corner, u, v);
  const TriangleNormal normal(corner);
  if (!normal.has_side) return point.rounded();
  // What the origin may be moved by along an axis, the rounding of its coordinate included, counts
  // towards X: 24 u X |n|_1 is far below X, and a unit in the last place is at most 2^-23.
  double reach = 0.0, sum = 0.0, facing = 0.0, uncertainty = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    double extent = 0x1p-22 * std::abs(point.at[axis]);
    for (int k = 0; k < 3; ++k) {
      extent = std::max(extent, std::abs(static_cast<double>(corner[k][axis]) - point.at[axis]) +
                                    0x1p-22 * std::abs(point.at[axis]));
    }
    reach = std::max(reach, extent);
    sum += std::abs(normal.n[axis]);
    facing += normal.n[axis] * static_cast<double>(direction[axis]);
    uncertainty = std::max(uncertainty, 2.0 * point.uncertainty[axis]);
  }
  // The last term: where numbers are denormal, roundings are absolute.
  const double distance = (24.0 * 0x1p-24 * reach + uncertainty) * sum + 0x1p-120;
  const double step = facing < 0.0 ? -distance : distance;
  Vec3f origin{};
  for (int axis = 0; axis < 3; ++axis) {
    // Each coordinate is rounded away from the plane, so that no rounding brings it nearer.
    const double moved = point.at[axis] + step * normal.n[axis];
    const double along = step * normal.n[axis];
    origin[axis] = along > 0.0   ? round_up(moved)
                   : along < 0.0 ? round_down(moved)
                                 : static_cast<float>(moved);
  }
  return origin;
}

}  // namespace kiwami
