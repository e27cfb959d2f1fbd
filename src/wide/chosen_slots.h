// SPDX-License-Identifier: Apache-2.0
// The children of a wide node while they are chosen among the nodes of a binary tree.
#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>

namespace kiwami {

constexpr uint32_t kMaxContractionWidth = 16;

/// A binary node that becomes a child: a node or a leaf.
struct ChosenSlot {
  uint32_t binary_node;
  bool is_leaf;
};

/// Divides leaves, those first whose halves add least weight, until there are width children or no
/// leaf can be divided; returns the number of children. Tree has
///   uint32_t left_child(uint32_t), right_child(uint32_t)
///   float added_weight(uint32_t): what two leaves in place of one add to the weight of leaves;
///     infinite where it cannot be divided
template <typename Tree>
uint32_t divide_leaves(const Tree& tree, ChosenSlot* chosen, uint32_t count, uint32_t width) {
  for (; count < width; ++count) {
    uint32_t best = count;
    float least = std::numeric_limits<float>::infinity();
    for (uint32_t i = 0; i < count; ++i) {
      const float added = chosen[i].is_leaf ? tree.added_weight(chosen[i].binary_node) : least;
      if (added < least) {
        least = added;
        best = i;
      }
    }
    if (best == count) break;
    const uint32_t divided = chosen[best].binary_node;
    std::copy_backward(chosen + best + 1, chosen + count, chosen + count + 1);
    chosen[best] = {tree.left_child(divided), true};
    chosen[best + 1] = {tree.right_child(divided), true};
  }
  return count;
}

}  // namespace kiwami
