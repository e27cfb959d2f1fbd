// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "kiwami/bvh.h"
#include "math/bounds.h"
#include "wide/binary_layout.h"

namespace kiwami {

/// Nodes and leaf blocks of a binary tree in one of the layouts, relative to the centre.
struct BinaryLayout {
  Array<BoxNode> boxes;        ///< of the layout BOXES
  Array<DualSplitNode> nodes;  ///< of the layout DUAL_SPLIT
  Array<IndexBlock<kBinaryBlockWidth>> blocks;
  Bounds bounds = Bounds::empty();  ///< of all, as they are stored
  uint64_t split_count = 0, carve_count = 0;

  uint64_t node_count() const { return boxes.size() + nodes.size(); }
  uint64_t node_bytes() const { return boxes.bytes() + nodes.bytes(); }
};

/// A tree that kiwami_bvh_build made: nodes breadth first, the primitives of each a run of ids.
struct FlatBinary {
  const Array<kiwami_bvh_node>& nodes;
  const Array<uint32_t>& primitive_ids;
  Vec3f centre;

  /// The box of a node relative to the centre, rounded outwards.
  Bounds stored_bounds(uint32_t node) const;
};

/// The boxes as they are.
BinaryLayout box_layout(const FlatBinary& tree, Memory& memory);

/// A dual-split tree (D. Lin, K. Shkurko, I. Mallett, C. Yuksel, "Dual-Split Trees", I3D 2019): of a
/// node the planes alone that its parent's box does not have. A split keeps the planes at which its
/// children face each other; carving nodes cut off what else is empty, where that saves more visits
/// than it costs. Departs from the paper in how nodes are encoded (see DualSplitNode), in the choice
/// of axis and of what is carved, by the surface area heuristic of the boxes that remain, and in
/// that a carving leaf always has two planes where two differ.
/// Throws Error(TOO_LARGE or OUT_OF_MEMORY).
BinaryLayout dual_split_layout(const FlatBinary& tree, Memory& memory);

/// The boxes of all triangles, relative to the centre and rounded outwards; empty for those that no
/// leaf holds.
struct PrimitiveBoxes {
  const Array<Bounds>& by_id;
  bool has_duplicates;
};

/// Checks every invariant of a layout: throws Error(VALIDATION).
void verify_binary_layout(const BinaryLayout& layout, const PrimitiveBoxes& primitives,
                          Memory& memory);

}  // namespace kiwami
