// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/sah_cost.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

struct ReinsertionConfig {
  /// How often candidates are searched for and moved.
  uint32_t rounds = 8;
  /// The part of all nodes, those of largest area, that is tried in each round, 0 to 1.
  float candidate_share = 0.05f;
  SahCosts costs = {};
};

/// Takes subtrees out and puts them back where the tree's surface area shrinks most: D. Meister,
/// J. Bittner, "Parallel Reinsertion for Bounding Volume Hierarchy Optimization", CGF 37(2), 2018;
/// the search is that of J. Bittner, M. Hapala, V. Havran, "Fast Insertion-Based Optimization of
/// Bounding Volume Hierarchies", CGF 32(1), 2013. All candidates of a round search the same tree in
/// parallel, without being taken out. Departs from the first in what follows: the moves are applied
/// one after the other, the best first, and each only if it still lowers the area of the tree as it
/// is by then; and subtrees that fill a leaf block stay whole. So the cost never rises and the tree
/// does not depend on the number of threads.
void optimize_by_parallel_reinsertion(BinaryBvh& bvh, const ReinsertionConfig& config,
                                      Memory& memory, const Parallel& parallel);

}  // namespace kiwami
