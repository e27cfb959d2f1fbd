// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "lights/draw.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Draws numbers in proportion to weights by the inverse of their cumulative distribution: [0, 1) is
/// cut into as many cells as there are weights, and the bounds that fall into a cell are searched by
/// a small binary tree: N. Binder, A. Keller, "Massively Parallel Construction of Radix Tree Forests
/// for the Efficient Sampling of Discrete Probability Distributions", 2019.
///
/// Departures: keys are doubles (their bits rise as they do), so that draws are as fine as a double
/// is; and each cell's tree is built by one thread with a stack (it is the Cartesian tree over the
/// highest bit in which neighbouring keys differ), the cells in parallel.
class RadixTreeForest {
 public:
  RadixTreeForest() = default;
  /// weights are 0 or more, finite, fewer than 2^31, not all 0.
  RadixTreeForest(const Array<double>& weights, Memory& memory, const Parallel& parallel);

  uint64_t bytes() const { return bounds_.bytes() + children_.bytes() + cells_.bytes(); }

  /// random is at least 0 and below 1. A number of weight 0 is never drawn.
  Draw draw(double random) const;
  double probability(uint32_t index) const;

  struct Steps {
    double mean;  ///< over all random numbers
    uint32_t most;
  };
  /// The comparisons that draws take: found by a walk over all nodes.
  Steps steps() const;

 private:
  /// A node j separates the intervals j and j + 1. A child that is an interval stands as its
  /// complement.
  struct Node {
    int32_t left, right;
  };

  uint32_t cell_of(double value) const;
  double upper_bound(uint32_t interval) const {
    return interval + 1 < bounds_.size() ? bounds_[interval + 1] : 1.0;
  }
  uint32_t first_node_of(uint32_t cell) const;
  uint64_t difference(uint32_t node, uint32_t cell) const;
  bool is_above(uint32_t node, uint32_t other, uint32_t cell) const;
  void plant(uint32_t cell, uint32_t begin, uint32_t end, uint32_t* stack);
  void add_steps(int32_t place, double low, double high, uint32_t depth, Steps& steps) const;

  Array<double> bounds_;  ///< the lower bound of each number's interval, rising
  Array<Node> children_;
  Array<int32_t> cells_;  ///< the root of each cell's tree, or the complement of an interval
};

}  // namespace kiwami
