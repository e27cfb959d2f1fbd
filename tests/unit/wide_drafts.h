// SPDX-License-Identifier: Apache-2.0
// What the tests of the direct builders of wide trees share.
#pragma once

#include <cmath>
#include <cstring>

#include "unit/tree_scenes.h"
#include "wide/wide_draft.h"

namespace kiwami_tests {

/// To the bit.
inline bool are_equal(const kiwami::WideDraft& a, const kiwami::WideDraft& b) {
  const auto arrays_are_equal = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.bytes()) == 0;
  };
  return arrays_are_equal(a.nodes, b.nodes) && arrays_are_equal(a.children, b.children) &&
         arrays_are_equal(a.boxes, b.boxes) && arrays_are_equal(a.leaf_sizes, b.leaf_sizes) &&
         arrays_are_equal(a.primitive_ids, b.primitive_ids) && a.depth == b.depth &&
         a.node_area == b.node_area && a.leaf_area == b.leaf_area;
}

/// Boxes in boxes: only one pair of such a row is each other's nearest.
inline Mesh nested(uint32_t count) {
  Mesh mesh;
  for (uint32_t i = 0; i < count; ++i) {
    const float size = std::pow(1.01f, static_cast<float>(i % 3000));
    mesh.add({-size, -size, -size}, {size, size, size}, {size, -size, size});
  }
  return mesh;
}

}  // namespace kiwami_tests
