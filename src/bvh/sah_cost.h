// SPDX-License-Identifier: Apache-2.0
// The cost of a binary tree by the surface area heuristic: J. D. MacDonald, K. S. Booth,
// "Heuristics for Ray Tracing Using Space Subdivision", The Visual Computer 6(3), 1990.
#pragma once

#include "bvh/binary_bvh.h"

namespace kiwami {

struct SahCosts {
  float node_cost = 1.0f;   ///< of visiting a node
  float leaf_cost = 1.0f;   ///< of testing one block of a leaf
  uint32_t block_size = 8;  ///< primitives that one leaf test takes at once

  uint32_t blocks_of(uint32_t count) const { return (count + block_size - 1) / block_size; }
};

/// Relative to the root; of a tree without area, the plain sum of the costs; 0 for an empty tree.
double sah_cost(const BinaryBvh& bvh, const SahCosts& costs);

}  // namespace kiwami
