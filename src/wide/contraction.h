// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// One child of a contracted node: the binary node that it was, and what it became: an index into
/// the contracted nodes, or kLeafFlag and the number of the leaf, counted in the order of slots.
struct ContractedSlot {
  uint32_t binary_node;
  uint32_t child;

  bool is_leaf() const { return (child & kLeafFlag) != 0; }
};

/// Owns slots[first_slot .. first_slot + slot_count).
struct ContractedNode {
  uint32_t first_slot;
  uint32_t slot_count;
};

/// The shape of a wide tree before it is packed. Slot 0 is the root, which may be a leaf. Parents
/// stand before their children, the inner children of a node stand side by side, and subtrees
/// follow each other depth first. A node with free slots has only leaves as children.
struct Contraction {
  Array<ContractedNode> nodes;
  Array<ContractedSlot> slots;
  uint32_t leaf_count = 0;
  uint32_t depth = 0;      ///< nodes on the longest path from the root
  double node_area = 0.0;  ///< sum of the half areas of the nodes
  double leaf_area = 0.0;  ///< sum of the half areas of the leaves
};

/// Contracts a binary tree to at most width children a node, guided by surface area: the inner
/// child of largest area is replaced by its children until width slots are used (Y. Gu, Y. He,
/// G. Blelloch, "Ray Specialized Contraction on Bounding Volume Hierarchies", CGF 34(7), 2015, with
/// areas in place of ray counts). So empty slots end up in the lowest nodes. The tree is not empty.
Contraction contract(const BinaryBvh& binary, uint32_t width, Memory& memory);

}  // namespace kiwami
