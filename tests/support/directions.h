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

/// Components that are often equal in size, zero or far apart; the greatest is about 1.
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
      case 4: {
        const float mantissa = random.symmetric();
        return std::ldexp(mantissa, random.between(-140, -20));
      }
      default:
        return random.symmetric();
    }
  };
  Point direction{component(), component(), component()};
  const bool is_tiny = std::fabs(direction.x) < 0x1p-20f && std::fabs(direction.y) < 0x1p-20f &&
                       std::fabs(direction.z) < 0x1p-20f;
  if (is_tiny) direction[random.between(0, 2)] = 1.0f;
  return direction;
}

inline Point random_direction(Random& random) {
  return {random.symmetric(), random.symmetric(), random.symmetric()};
}

/// a + s (b - a), with s a multiple of 1/64 so that the sum is often exact.
inline Point between(Point a, Point b, Random& random) {
  return a + (b - a) * (static_cast<float>(random.between(0, 64)) / 64.0f);
}

}  // namespace kiwami_tests
