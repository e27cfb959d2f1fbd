// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_draft.h"

namespace kiwami {

struct WideLinearConfig {
  uint32_t width = 8;       ///< children a node: 4, 8 or 16
  uint32_t leaf_width = 8;  ///< primitives a leaf, at most the width
  /// Cells of at most so many primitives are built by one thread each.
  uint32_t part_size = 16384;
};

/// The cells of a Morton curve, straight as a wide tree: C. Lauterbach, M. Garland, S. Sengupta,
/// D. Luebke, D. Manocha, "Fast BVH Construction on GPUs", CGF 28(2), 2009. Departs from it in that
/// no binary tree is kept: a node begins as one cell, and the largest of its cells is halved until
/// all slots are used, or all cells fit a leaf each. The codes are the extended ones, whose cells
/// follow the shape of the scene and part large boxes from small ones. The same tree for any number
/// of threads.
WideDraft build_wide_linear(Array<BuildPrimitive> primitives, const WideLinearConfig& config,
                            Memory& memory, const Parallel& parallel);

}  // namespace kiwami
