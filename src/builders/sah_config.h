// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstdint>

namespace kiwami {

/// What all top-down builders by the surface area heuristic are told.
struct SahConfig {
  /// No leaf owns more primitives.
  uint32_t max_leaf_size = 8;
  /// Primitives that one leaf test takes at once: the cost of a leaf counts such blocks.
  uint32_t block_size = 8;
  /// Cost of visiting a node.
  float node_cost = 1.0f;
  /// Cost of testing one block.
  float leaf_cost = 1.0f;
  /// Subtrees of at most this many primitives are built by one thread; 0: chosen by the number
  /// of primitives. The shape of the tree does not depend on it.
  uint32_t subtree_size = 0;

  /// The size of subtrees in a build of so many primitives: enough of them to keep many threads
  /// busy, each worth starting a task.
  uint32_t subtree_size_of(uint32_t count) const {
    const uint32_t size = subtree_size != 0 ? subtree_size : std::clamp(count / 256, 4096u, 32768u);
    return std::max(size, max_leaf_size);
  }
};

}  // namespace kiwami
