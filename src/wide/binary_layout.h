// SPDX-License-Identifier: Apache-2.0
// Layouts of a binary tree that rays go through as it is. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>

#include "wide/wide_bvh.h"

namespace kiwami {

/// Triangles of a leaf: one IndexBlock.
constexpr int kBinaryBlockWidth = 4;

/// A node with its box, relative to the tree's centre and rounded outwards. An inner node has its
/// children at first and first + 1; a leaf the number of its block there.
struct BoxNode {
  float bounds[3][2];  ///< by axis: lower, upper
  uint32_t first;
  uint32_t is_leaf;
};
static_assert(sizeof(BoxNode) == 32);

/// A node of a dual-split tree: two planes, relative to the tree's centre and rounded outwards. What
/// they mean, and where the children are, stands in the header. The nodes stand depth first: the
/// lower child of a split, and what a carving node carves, comes next.
struct DualSplitNode {
  enum Kind : uint32_t {
    kSplit,       ///< the lower child ends at plane 0, the upper one begins at plane 1
    kCarve,       ///< cuts off what is beyond the planes
    kCarvedLeaf,  ///< the same of a leaf
    kLeaf         ///< without planes
  };
  /// A side of a box: what is cut off is beyond it.
  struct Side {
    uint32_t axis;
    uint32_t is_upper;
  };
  static constexpr uint32_t kMaxOffset = (1u << 28) - 1;
  static constexpr uint32_t kMaxBlock = (1u << 24) - 1;

  uint32_t header;
  float plane[2];

  static uint32_t split_header(uint32_t axis, uint32_t offset) {
    return kSplit | axis << 2 | offset << 4;
  }
  static uint32_t carve_header(Kind kind, Side first, Side second, uint32_t block) {
    return kind | code_of(first) << 2 | code_of(second) << 5 | block << 8;
  }

  Kind kind() const { return static_cast<Kind>(header & 3u); }
  bool is_leaf() const { return (header & 2u) != 0; }
  uint32_t axis() const { return (header >> 2) & 3u; }
  uint32_t upper_offset() const { return header >> 4; }
  Side side(int k) const {
    const uint32_t code = (header >> (k == 0 ? 2 : 5)) & 7u;
    return {code >> 1, code & 1u};
  }
  uint32_t block() const { return header >> 8; }

 private:
  static uint32_t code_of(Side side) { return side.axis << 1 | side.is_upper; }
};
static_assert(sizeof(DualSplitNode) == 12);

/// What kernels read of a tree in either layout.
struct BinaryTreeView {
  SceneView scene;  ///< of the one mesh; its tree's memory holds the leaves' blocks
  const BoxNode* boxes;
  const DualSplitNode* nodes;  ///< a dual-split tree's
  float bounds[3][2];          ///< of all, as in BoxNode
  uint32_t node_count;
};

struct BinaryTreeCounters {
  uint64_t node_visits, plane_tests, leaf_visits;
};

}  // namespace kiwami
