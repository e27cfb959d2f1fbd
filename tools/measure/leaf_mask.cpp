// SPDX-License-Identifier: Apache-2.0
#include "measure/leaf_mask.h"

#include <kiwami/opacity.h>

#include <algorithm>

namespace kiwami::tools {

bool is_on_leaf(float u, float v) {
  // 1 in the middle of the triangle, 0 at its sides.
  return 27.0f * u * v * (1.0f - u - v) >= 0.25f;
}

std::vector<unsigned char> leaf_map(uint32_t level) {
  const uint32_t rows = 1u << level;
  const auto step = 1.0f / static_cast<float>(rows);
  std::vector<unsigned char> map(std::max<size_t>(1, (size_t{1} << (2 * level)) / 8));
  const auto set = [&](float u, float v) {
    const uint32_t number = kiwami_opacity_micro_triangle(u, v, level);
    if (is_on_leaf(u, v)) map[number / 8] |= static_cast<unsigned char>(1u << (number % 8));
  };
  for (uint32_t row = 0; row < rows; ++row) {
    for (uint32_t column = 0; row + column < rows; ++column) {
      const float u = static_cast<float>(column), v = static_cast<float>(row);
      set((u + 1.0f / 3) * step, (v + 1.0f / 3) * step);
      if (row + column + 1 < rows) set((u + 2.0f / 3) * step, (v + 2.0f / 3) * step);
    }
  }
  return map;
}

}  // namespace kiwami::tools
