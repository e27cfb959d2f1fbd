// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// Marks the number of a leaf among those of nodes.
constexpr uint32_t kLeafFlag = 0x80000000u;

/// One child of a contracted node: the binary node that it was, and what it became: an index into
/// the contracted nodes, or kLeafFlag and the number of the leaf, counted in the order of slots.
/// A leaf owns all primitives below its binary node, which need not be a leaf.
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
/// stand before their children, the inner children of a node stand side by side, and below the
/// nodes near the root subtrees follow each other depth first.
struct Contraction {
  Array<ContractedNode> nodes;
  Array<ContractedSlot> slots;
  Array<uint8_t> leaf_sizes;  ///< primitives, by number of the leaf
  uint32_t depth = 0;         ///< nodes on the longest path from the root
  double node_area = 0.0;     ///< sum of the half areas of the nodes
  double leaf_area = 0.0;     ///< sum of the half areas of the leaves
};

/// Contracts a binary tree to at most width children a node, guided by surface area: the inner
/// child of largest area is replaced by its children until width slots are used (Y. Gu, Y. He,
/// G. Blelloch, "Ray Specialized Contraction on Bounding Volume Hierarchies", CGF 34(7), 2015, with
/// areas in place of ray counts). So a node with free slots has only leaves as children. The tree
/// is not empty, and no leaf owns more than 255 primitives.
Contraction contract(const BinaryBvh& binary, uint32_t width, Memory& memory,
                     const Parallel& parallel);

}  // namespace kiwami
