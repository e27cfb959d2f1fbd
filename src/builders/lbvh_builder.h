// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/morton_order.h"
#include "bvh/sah_cost.h"

namespace kiwami {

/// A linear BVH over Morton codes, from the leaves up in one pass: C. Apetrei, "Fast and Simple
/// Agglomerative LBVH Construction", CGVC 2014. Each leaf climbs; of the two that meet at a node
/// the second goes on. Which neighbour a range joins is decided by the lesser of two deltas at its
/// ends, so any delta gives a tree. Departs from it in 63-bit codes, and in a delta that is never
/// equal for two neighbours: equal codes are told apart by their places, which halves their runs.
/// Subtrees become leaves on the way up, where their primitives stand side by side already.
class LbvhBuilder {
 public:
  /// What is compared at the border between two neighbours.
  enum class Delta {
    kCode,        ///< the highest bit in which their codes differ: halves of cells
    kSurfaceArea  ///< the area of the box around both
  };
  struct Config {
    Delta delta = Delta::kCode;
    CurveCode curve_code = CurveCode::kPlain;
    uint32_t chunk_size = 1;  ///< primitives of a leaf at most (leaves_by_area)
    /// Subtrees of at most so many primitives become one leaf where that is no dearer.
    uint32_t max_leaf_size = 1;
    SahCosts costs = {};
  };

  /// The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami
