// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/morton_order.h"
#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_draft.h"

namespace kiwami {

struct WideBottomUpConfig {
  uint32_t width = 8;       ///< children a node: 4, 8 or 16
  uint32_t leaf_width = 8;  ///< primitives a leaf, at most the width
  float node_cost = 1.0f;   ///< of a node, times its area
  float leaf_cost = 1.0f;   ///< of a leaf, whatever it owns, times its area
  bool fill_nodes = false;  ///< as in optimal_contraction.h
  uint32_t radius = 4;      ///< places to each side that are looked at: 4, 8 or 16
  CurveCode curve_code = CurveCode::kPlain;
  /// Clusters that one thread joins at a time, at least 256. Within them the choice of nodes is the
  /// best one; what a block ends with is not divided any more.
  uint32_t block_size = 2048;
  /// A block ends when there are so many times fewer clusters.
  uint32_t reduction = 64;
};

/// A wide tree from the leaves up, of which no binary tree is kept. Primitives stand along a Morton
/// curve, cut into blocks. In each block clusters join by locally ordered clustering (D. Meister,
/// J. Bittner, "Parallel Locally-Ordered Clustering for Bounding Volume Hierarchy Construction",
/// TVCG 24(3), 2018), and each carries its least costs as at most 1, 2, ... children of one wide
/// node: the dynamic programme of optimal_contraction.h, solved while the tree grows. When few
/// clusters are left, each of them is committed: it becomes one child, its wide nodes are written
/// and the pairs that it was made of are forgotten. What was committed stands in the blocks of the
/// next level, until one is left. So pairs exist only within the blocks that are being built. The
/// same tree for any number of threads.
WideDraft build_wide_bottom_up(Array<BuildPrimitive> primitives, const WideBottomUpConfig& config,
                               Memory& memory, const Parallel& parallel);

}  // namespace kiwami
