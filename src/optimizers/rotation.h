// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/sah_cost.h"
#include "core/memory.h"

namespace kiwami {

struct RotationConfig {
  uint32_t rounds = 4;  ///< passes over the tree; fewer where a pass finds nothing
  SahCosts costs = {};
};

/// Swaps a child of a node with one below its other child, or two below different children, where
/// that shrinks a box: A. Kensler, "Tree Rotations for Improving Bounding Volume Hierarchies", IRT
/// 2008. Goes over the tree from below, takes the best rotation of each node and never one that
/// does not pay; without the paper's simulated annealing. Subtrees that fill a leaf block stay
/// whole. One thread: a pass costs less than sorting the primitives.
void optimize_by_rotation(BinaryBvh& bvh, const RotationConfig& config, Memory& memory);

}  // namespace kiwami
