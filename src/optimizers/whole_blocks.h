// SPDX-License-Identifier: Apache-2.0
// Subtrees that will become one leaf block, kept whole while a tree is optimised.
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/sah_cost.h"

namespace kiwami {

/// Marks as leaves the subtrees that fill a leaf block and cost no more as one block than as
/// several: optimisers look at the area of inner nodes alone, and would pull them apart to shrink
/// boxes that the wide tree does not have. The tree is numbered depth first.
class WholeBlocks {
 public:
  WholeBlocks(BinaryBvh& bvh, const SahCosts& costs, Memory& memory);

  /// Whether a node of the tree as it was marked stands below a marked one.
  bool is_inside(uint32_t slot) const { return is_inside_[slot] != 0; }

  /// Ends the marks, wherever their nodes are by now.
  static void release(BinaryBvh& bvh);

 private:
  Array<uint8_t> is_inside_;
};

}  // namespace kiwami
