// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/sah_cost.h"
#include "core/memory.h"

namespace kiwami {

struct SequentialReinsertionConfig {
  /// The part of all nodes that is ranked anew and taken out in each round, 0 to 1.
  float batch_share = 0.01f;
  uint32_t rounds = 100;
  SahCosts costs = {};
};

/// Takes out the nodes that waste most area, one after the other, and puts the two subtrees of each
/// back where they add least, each place found by branch and bound over the whole tree: J. Bittner,
/// M. Hapala, V. Havran, "Fast Insertion-Based Optimization of Bounding Volume Hierarchies", CGF
/// 32(1), 2013. Departs from it in what follows: a node whose children found no better places is
/// put back as it was and not tried again, where the paper turns to random nodes, so the area never
/// rises; and subtrees that fill a leaf block stay whole. One thread.
void optimize_by_reinsertion(BinaryBvh& bvh, const SequentialReinsertionConfig& config,
                             Memory& memory);

}  // namespace kiwami
