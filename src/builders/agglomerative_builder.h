// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Agglomerative clustering: of all pairs of clusters the nearest one joins, again and again.
/// B. Walter, K. Bala, M. Kulkarni, K. Pingali, "Fast Agglomerative Clustering for Rendering", IRT
/// 2008. Makes the same tree as trying all pairs would. Departs from the paper in how: all pairs
/// that are each other's nearest join at once (PairKey says why that is the same), and the nearest
/// ones are searched for in parallel, in a tree over the clusters' order along a Morton curve. A
/// search prunes exactly and takes logarithmic time on real scenes, a round linear time besides;
/// about n log n in all, with a factor that is tens of times that of other builders, and cubic at
/// worst, where every box meets every other one. Few clusters are left to a distance matrix.
class AgglomerativeBuilder {
 public:
  struct Config {
    uint32_t matrix_size = 512;  ///< so many clusters or fewer are joined by a matrix; 1: none
  };

  /// One primitive a leaf. The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami
