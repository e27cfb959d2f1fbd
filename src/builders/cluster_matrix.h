// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/clusters.h"

namespace kiwami {

/// Greedy clustering over the matrix of all distances: quadratic in the number of clusters, in time
/// and memory. Keeps its memory from call to call.
class ClusterMatrix {
 public:
  explicit ClusterMatrix(Memory& memory) : memory_(memory) {}

  /// Joins the least pair until no more than `target` clusters are left, at least one; they stand
  /// at the front then. Returns how many there are.
  uint32_t combine(Cluster* clusters, uint32_t count, uint32_t target, BinaryBvh& bvh);

 private:
  float* row(uint32_t i) { return distances_.data() + size_t{i} * stride_; }
  void reserve(uint32_t count);
  void fill();
  void find_nearest(uint32_t i);
  uint32_t least_row() const;
  void join_rows(uint32_t i, uint32_t j, BinaryBvh& bvh);

  Memory& memory_;
  Array<float> distances_;  ///< by row and column; of a row with itself: infinite
  Array<uint32_t> nearest_;
  Array<PairKey> keys_;  ///< of each row with its nearest
  Cluster* clusters_ = nullptr;
  uint32_t count_ = 0, stride_ = 0;
};

}  // namespace kiwami
