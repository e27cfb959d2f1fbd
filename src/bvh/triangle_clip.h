// SPDX-License-Identifier: Apache-2.0
// The parts of a triangle on both sides of a plane, as boxes that are rounded outwards.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "math/bounds.h"
#include "math/rounding.h"

namespace kiwami {

/// A box around the point where the edge from a to b, which lie strictly on different sides of the
/// plane, crosses it.
///
/// The crossing is computed in double from floats. Its ratio has a relative error of at most 3 u
/// (u = 2^-53), its product with the difference one of 5 u, the sum adds one more; the product is
/// at most |a| + |b|. So the error is below 8 u (|a| + |b|), and nothing is denormal: products of
/// differences of floats are far above the least double.
inline Bounds crossing_of(Vec3f a, Vec3f b, int axis, float plane) {
  if (a[axis] > b[axis]) std::swap(a, b);  // So both triangles at an edge cut it alike.
  const double begin = a[axis], end = b[axis];
  const double ratio = (static_cast<double>(plane) - begin) / (end - begin);
  Bounds box;
  for (int k = 0; k < 3; ++k) {
    const double from = a[k], to = b[k];
    const double value = from + ratio * (to - from);
    const double error = 0x1p-50 * (std::fabs(from) + std::fabs(to));
    // The true crossing lies between the two ends.
    box.lower[k] = std::max(round_down(value - error), std::min(a[k], b[k]));
    box.upper[k] = std::min(round_up(value + error), std::max(a[k], b[k]));
  }
  box.lower[axis] = box.upper[axis] = plane;
  return box;
}

/// The parts of a triangle within a box that lie below and above a plane. Each point of the
/// triangle that lies in the box lies in side[0] or side[1]; a side without such points may be
/// empty.
inline void split_triangle(const Vec3f corner[3], const Bounds& box, int axis, float plane,
                           Bounds side[2]) {
  side[0] = side[1] = Bounds::empty();
  for (int k = 0; k < 3; ++k) {
    const Vec3f& from = corner[k];
    const Vec3f& to = corner[k == 2 ? 0 : k + 1];
    if (from[axis] <= plane) side[0].extend(from);
    if (from[axis] >= plane) side[1].extend(from);
    const bool crosses =
        (from[axis] < plane) != (to[axis] < plane) && from[axis] != plane && to[axis] != plane;
    if (!crosses) continue;
    const Bounds crossing = crossing_of(from, to, axis, plane);
    side[0].extend(crossing);
    side[1].extend(crossing);
  }
  side[0] = intersection_of(side[0], box);
  side[1] = intersection_of(side[1], box);
}

}  // namespace kiwami
