// SPDX-License-Identifier: Apache-2.0
// Directions and points that the ray generators share.
#pragma once

#include "support/mesh.h"
#include "support/random.h"

namespace kiwami_tests {

inline bool is_zero(Point p) { return p.x == 0.0f && p.y == 0.0f && p.z == 0.0f; }

/// One of the six axis directions, with zeros of both signs.
inline Point axis_direction(Random& random) {
  const auto zero = [&] { return random.one_in(2) ? 0.0f : -0.0f; };
  Point direction{zero(), zero(), zero()};
  direction[random.between(0, 2)] = random.one_in(2) ? 1.0f : -1.0f;
  return direction;
}

/// Components that are often equal in size, zero or far apart.
inline Point odd_direction(Random& random) {
  const auto component = [&]() -> float {
    switch (random.below(6)) {
      case 0:
        return 0.0f;
      case 1:
        return -0.0f;
      case 2:
        return 1.0f;
      case 3:
        return -1.0f;
      case 4:
        return std::ldexp(random.symmetric(), random.between(-140, -20));
      default:
        return random.symmetric();
    }
  };
  return {component(), component(), component()};
}

inline Point random_direction(Random& random) {
  return {random.symmetric(), random.symmetric(), random.symmetric()};
}

/// a + s (b - a), with s a multiple of 1/64 so that the sum is often exact.
inline Point between(Point a, Point b, Random& random) {
  return a + (b - a) * (static_cast<float>(random.between(0, 64)) / 64.0f);
}

}  // namespace kiwami_tests
