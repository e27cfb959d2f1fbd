// SPDX-License-Identifier: Apache-2.0
// The micro-triangles of an opacity micromap.
//
// Their order, and a picture of it, are in kiwami/opacity.h: by rows of rising v, and in each row
// by rising u, upright ones and turned ones by turns; row r has 2 (n - r) - 1 of them, n = 2^level.
#pragma once

#include <cstdint>

namespace kiwami {

/// The number of the micro-triangle at (u, v). Exact: multiplying by a power of two and taking away
/// whole parts are, and so is the comparison, since 1 - x is for x >= 1/2 (P. H. Sterbenz,
/// "Floating-Point Computation", 1974) and, where both parts are below 1/2, decides nothing. What
/// rounding has left outside of the triangle goes to the nearest in its row.
// Static and inlined by force: it stands in kernels, whose functions must not be shared.
__attribute__((always_inline)) static inline uint32_t micro_triangle_at(float u, float v,
                                                                        uint32_t level) {
  const uint32_t n = 1u << level;
  const float scale = static_cast<float>(n);
  const float column = u > 0.0f ? u * scale : 0.0f;
  const float row = v > 0.0f ? v * scale : 0.0f;
  const uint32_t last = n - 1;
  const uint32_t r = row < scale ? static_cast<uint32_t>(row) : last;
  uint32_t i = column < scale ? static_cast<uint32_t>(column) : last;
  if (i > last - r) i = last - r;
  const float in_column = column - static_cast<float>(i), in_row = row - static_cast<float>(r);
  const float larger = in_column > in_row ? in_column : in_row;
  const float smaller = in_column > in_row ? in_row : in_column;
  const bool is_turned = i < last - r && smaller > 1.0f - larger;
  return r * (2 * n - r) + 2 * i + (is_turned ? 1 : 0);
}

}  // namespace kiwami
