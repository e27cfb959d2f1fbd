// SPDX-License-Identifier: Apache-2.0
// What builders and optimisers do to a binary tree when its shape is settled.
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/sah_cost.h"

namespace kiwami {

/// Numbers the nodes depth first (siblings stay adjacent, so a node's children follow what stands
/// below its left sibling) and puts primitive_ids in the order of the leaves. Nodes may stand in
/// any order before, with gaps between them, and at any depth; node 0 is the root. So trees of one
/// shape become equal to the byte, and all primitives below a node stand side by side.
void relabel_depth_first(BinaryBvh& bvh, Memory& memory);

/// Rebuilds by halving what would pass BinaryBvh::kMaxDepth, and nothing else: each subtree that
/// goes too deep is left as it is down to the last level from which halving still fits. The tree is
/// numbered depth first, before and after.
void limit_depth(BinaryBvh& bvh, Memory& memory);

/// Makes a leaf of each subtree of at most max_leaf_size primitives that is cheaper as one. The
/// tree is numbered depth first, before and after.
void collapse_leaves(BinaryBvh& bvh, uint32_t max_leaf_size, const SahCosts& costs, Memory& memory);

}  // namespace kiwami
