// SPDX-License-Identifier: Apache-2.0
// Codes that order points along a Z-shaped curve: G. M. Morton, "A Computer Oriented Geodetic Data
// Base and a New Technique in File Sequencing", IBM technical report, 1966.
#pragma once

#include <cstdint>

#include "math/bounds.h"

namespace kiwami {

constexpr uint32_t kMortonBits = 21;  ///< of each axis in a code

/// Bit i of the low 21 goes to bit 3 i.
inline uint64_t spread_by_three(uint64_t value) {
  value &= 0x1FFFFF;
  value = (value | value << 32) & 0x001F00000000FFFFull;
  value = (value | value << 16) & 0x001F0000FF0000FFull;
  value = (value | value << 8) & 0x100F00F00F00F00Full;
  value = (value | value << 4) & 0x10C30C30C30C30C3ull;
  return (value | value << 2) & 0x1249249249249249ull;
}

/// Maps the points of a box to codes of 63 bits.
class MortonGrid {
 public:
  explicit MortonGrid(const Bounds& bounds) : lower_(bounds.lower) {
    for (int axis = 0; axis < 3; ++axis) {
      const float extent = bounds.upper[axis] - bounds.lower[axis];
      // A flat axis, or one below the least normal float, tells no points apart.
      scale_[axis] = extent > 1e-34f ? kCells / extent : 0.0f;
    }
  }

  uint64_t code(const Vec3f& point) const {
    uint64_t code = 0;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = (point[axis] - lower_[axis]) * scale_[axis];
      // A conversion to a signed number of 32 bits is one instruction.
      code |= spread_by_three(
                  static_cast<uint32_t>(static_cast<int32_t>(cell < kCells ? cell : kCells)))
              << axis;
    }
    return code;
  }

 private:
  static constexpr float kCells = static_cast<float>((1u << kMortonBits) - 1);
  Vec3f lower_;
  float scale_[3];
};

}  // namespace kiwami
