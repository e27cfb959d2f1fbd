// SPDX-License-Identifier: Apache-2.0
// The binary tree that all builders make and all optimisers edit.
#pragma once

#include <algorithm>
#include <cstdint>

#include "core/memory.h"
#include "math/bounds.h"

namespace kiwami {

/// The box of one primitive and its number: what builders sort and partition.
struct BuildPrimitive {
  Vec3f lower;
  uint32_t id;
  Vec3f upper;
  uint32_t reserved;

  Bounds bounds() const { return {lower, upper}; }
  /// Twice the centroid, which saves a multiplication and a rounding.
  Vec3f doubled_centroid() const { return lower + upper; }
};
static_assert(sizeof(BuildPrimitive) == 32);

/// An inner node has count 0 and its children at first and first + 1; a leaf owns
/// primitive_ids[first .. first + count).
struct BinaryNode {
  Bounds bounds;
  uint32_t first;
  uint32_t count;

  bool is_leaf() const { return count != 0; }
};
static_assert(sizeof(BinaryNode) == 32);

/// Node 0 is the root; children stand after their parents. No nodes at all: no primitives.
/// Nodes that no other node names (gaps left by builders) may stand between them.
struct BinaryBvh {
  Array<BinaryNode> nodes;
  Array<uint32_t> primitive_ids;
  /// Spatial splits: a triangle may stand in several leaves, each around a part of it.
  bool has_duplicates = false;

  /// No path from the root to a leaf has more nodes than this; builders keep to it, so that the
  /// traversal stack has a fixed size.
  static constexpr uint32_t kMaxDepth = 72;
};

/// Calls visit(leaf) for each leaf at and below a node, from left to right.
template <typename Visit>
void for_each_leaf(const BinaryBvh& bvh, uint32_t node, Visit&& visit) {
  // Each step down pushes two and pops one.
  uint32_t stack[BinaryBvh::kMaxDepth + 1];
  uint32_t size = 0;
  stack[size++] = node;
  while (size != 0) {
    const BinaryNode& top = bvh.nodes[stack[--size]];
    if (top.is_leaf()) {
      visit(top);
    } else {
      stack[size++] = top.first + 1;
      stack[size++] = top.first;
    }
  }
}

/// Writes the ids of all primitives below a node, from left to right, each once; returns the end.
inline uint32_t* copy_ids_below(const BinaryBvh& bvh, uint32_t node, uint32_t* ids) {
  uint32_t* end = ids;
  for_each_leaf(bvh, node, [&](const BinaryNode& leaf) {
    for (uint32_t i = leaf.first; i < leaf.first + leaf.count; ++i) {
      const uint32_t id = bvh.primitive_ids[i];
      if (!bvh.has_duplicates || std::find(ids, end, id) == end) *end++ = id;
    }
  });
  return end;
}

}  // namespace kiwami
