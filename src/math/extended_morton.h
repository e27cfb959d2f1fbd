// SPDX-License-Identifier: Apache-2.0
// Codes along a curve that knows the shape of the scene and the size of its objects: M. Vinkler,
// J. Bittner, V. Havran, "Extended Morton Codes for High Performance Bounding Volume Hierarchy
// Construction", HPG 2017.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/bounds.h"

namespace kiwami {

/// Maps boxes to codes of 63 bits. Each bit halves the cell along its longest axis, so flat scenes
/// spend no bits on what is thin; every fourth bit is one of the box's diagonal, so that large
/// boxes leave the small ones in their cell.
class ExtendedMortonGrid {
 public:
  static constexpr uint32_t kBits = 63;
  static constexpr uint32_t kSizePeriod = 4;
  /// Bits of one axis; a float tells no more cells apart.
  static constexpr uint32_t kMostAxisBits = 24;
  static constexpr uint32_t kSize = 3;  ///< the quantity after the three axes

  /// The boxes of all doubled centroids, and of all objects.
  ExtendedMortonGrid(const Bounds& centroids, const Bounds& objects) : lower_(centroids.lower) {
    float extent[3];
    for (int axis = 0; axis < 3; ++axis) {
      extent[axis] = centroids.upper[axis] - centroids.lower[axis];
      // A flat axis, or one below the least normal float, tells no points apart.
      cell_[axis] = extent[axis] > 1e-34f ? extent[axis] : 0.0f;
    }
    choose_bits();
    for (int axis = 0; axis < 3; ++axis) {
      cells_[axis] = static_cast<float>(1u << bits_[axis]);
      scale_[axis] = bits_[axis] != 0 ? cells_[axis] / extent[axis] : 0.0f;
    }
    const double diagonal = diagonal_of(objects);
    size_scale_ = diagonal > 0.0 ? static_cast<double>(1u << bits_[kSize]) / diagonal : 0.0;
  }

  uint64_t code(const Bounds& box) const {
    uint64_t code = 0;
    const Vec3f point = box.lower + box.upper;
    for (int axis = 0; axis < 3; ++axis) {
      const float cell = (point[axis] - lower_[axis]) * scale_[axis];
      code |= spread(axis, static_cast<uint32_t>(std::min(cell, cells_[axis] - 1.0f)));
    }
    const double size = diagonal_of(box) * size_scale_;
    const double most = static_cast<double>((1u << bits_[kSize]) - 1);
    return code | spread(kSize, static_cast<uint32_t>(std::min(size, most)));
  }

 private:
  static double diagonal_of(const Bounds& box) {
    const double x = box.upper.x - box.lower.x, y = box.upper.y - box.lower.y;
    const double z = box.upper.z - box.lower.z;
    return std::sqrt(x * x + y * y + z * z);
  }

  /// Which quantity each bit of the code is of, from the highest on, as tables by bytes. The last
  /// bits are none's where all axes are as fine as floats are, or flat.
  void choose_bits() {
    uint32_t quantity_of[kBits];
    uint32_t used = 0;
    for (; used < kBits; ++used) {
      const uint32_t quantity = used % kSizePeriod == kSizePeriod - 1 ? kSize : longest_axis();
      if (quantity == kNone) break;
      quantity_of[used] = quantity;
      ++bits_[quantity];
      if (quantity != kSize) cell_[quantity] *= 0.5f;
    }
    uint32_t left[4];
    std::copy_n(bits_, 4, left);
    for (uint32_t i = 0; i < used; ++i) {
      const uint32_t quantity = quantity_of[i], bit = --left[quantity];
      const uint64_t in_code = uint64_t{1} << (kBits - 1 - i);
      for (uint32_t value = 0; value < 256; ++value) {
        if ((value >> bit % 8 & 1) != 0) tables_[quantity][bit / 8][value] |= in_code;
      }
    }
  }

  /// Of equal ones the last, as in plain codes.
  uint32_t longest_axis() const {
    uint32_t longest = kNone;
    for (uint32_t axis = 0; axis < 3; ++axis) {
      if (cell_[axis] == 0.0f || bits_[axis] == kMostAxisBits) continue;
      if (longest == kNone || cell_[axis] >= cell_[longest]) longest = axis;
    }
    return longest;
  }

  uint64_t spread(uint32_t quantity, uint32_t value) const {
    const auto& table = tables_[quantity];
    return table[0][value & 255] | table[1][value >> 8 & 255] | table[2][value >> 16];
  }

  static constexpr uint32_t kNone = ~0u;

  Vec3f lower_;
  float cell_[3];  ///< what is left of each axis in a cell, while bits are chosen
  uint32_t bits_[4] = {};
  float cells_[3], scale_[3];
  double size_scale_;
  uint64_t tables_[4][3][256] = {};
};

}  // namespace kiwami
