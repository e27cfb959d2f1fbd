// SPDX-License-Identifier: Apache-2.0
// The binary tree that all builders make and all optimisers edit.
#pragma once

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

  /// No path from the root to a leaf has more nodes than this; builders keep to it, so that the
  /// traversal stack has a fixed size.
  static constexpr uint32_t kMaxDepth = 72;
};

}  // namespace kiwami
