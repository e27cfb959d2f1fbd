// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/joined_nodes.h"
#include "builders/sah_config.h"
#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Top-down construction by the surface area heuristic over bins of centroids: I. Wald, "On fast
/// Construction of SAH-based Bounding Volume Hierarchies", IRT 2007. Departs from it in counting
/// full leaf blocks instead of primitives, and in stable partitions, so that the tree does not
/// depend on the number of threads: near the root by primitives, below by subtrees.
class BinnedSahBuilder {
 public:
  struct Config : SahConfig {
    /// Bins per axis, 2 to 32; nodes of few primitives use fewer (see bins_of).
    uint32_t bin_count = 16;
    /// Every so many levels the bins are halved, down to 8; 0: never.
    uint32_t bin_halving_depth = 0;
    /// Let primitives that the plane of a split cuts go to the cheaper side (see Reassignment).
    bool reassigns = false;
  };

  /// The bins per axis that a node of so many primitives uses, the root being at depth 1: more than
  /// its primitives would only be cleared and scanned in vain.
  static uint32_t bins_of(uint32_t primitive_count, uint32_t depth, const Config& config);

  /// Takes the primitives, to free them before the tree is complete: 40 bytes a primitive and the
  /// nodes are the most that a build holds.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);

  /// Builds the tree in parts, for whoever keeps no binary one; returns the ids of the primitives,
  /// in the order of the tree. There is at least one primitive.
  static Array<uint32_t> build_parts(Array<BuildPrimitive> primitives, const Config& config,
                                     TreeParts& parts, Memory& memory, const Parallel& parallel);
};

}  // namespace kiwami
