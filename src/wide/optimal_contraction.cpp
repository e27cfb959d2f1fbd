// SPDX-License-Identifier: Apache-2.0
#include "wide/optimal_contraction.h"

#include <algorithm>
#include <limits>

#include "wide/contraction_walk.h"

namespace kiwami {
namespace {

/// What the least costs of a node's subtree are when it becomes at most 1, 2, ... children of one
/// wide node. Costs beyond the last entry are equal to it.
struct CostRow {
  uint32_t size;
  uint32_t primitive_count;           ///< not above leaf_width + 1
  double cost[kMaxContractionWidth];  ///< [i]: of at most i + 1 children
};

/// The decisions for one node, four bits each. Number 1: is the node a leaf where it becomes one
/// child? Number i up to width - 1: how many of i children come from its left child; 0: i - 1
/// children are as good. Number width: the same for the children of the node itself.
class Decisions {
 public:
  uint32_t get(uint32_t number) const {
    return static_cast<uint32_t>(bits_ >> (4 * (number - 1))) & 15u;
  }
  void add(uint32_t number, uint32_t decision) {
    bits_ |= uint64_t{decision} << (4 * (number - 1));
  }

 private:
  uint64_t bits_ = 0;
};

/// Finds the decisions, bottom up: the nodes near the root after the subtrees below them.
class OptimalChooser {
 public:
  OptimalChooser(const BinaryBvh& binary, const OptimalContractionConfig& config, Memory& memory)
      : binary_(binary),
        width_(config.width),
        leaf_width_(config.leaf_width),
        fill_from_(config.fill_nodes ? config.width / 2 + 2 : config.width),
        node_cost_(config.node_cost),
        leaf_cost_(config.leaf_cost),
        visit_weights_(config.visit_weights),
        decisions_(memory, binary.nodes.size()) {
    const double root_weight = measured_weight_of(0);
    least_weight_ = root_weight > 0.0 ? root_weight * 0x1p-64 : 1.0;
  }

  void decide(Memory& memory, const Parallel& parallel) {
    GrowingArray<TopNode> top(memory);
    top.push_back({0, 0, {}});
    const size_t first_subtree = open_top(top);
    parallel.for_each(top.size() - first_subtree, [&](size_t i) {
      TopNode& node = top[first_subtree + i];
      solve(node.binary_node, node.row);
    });
    for (size_t i = first_subtree; i-- > 0;) {
      TopNode& node = top[i];
      if (node.first_child == 0) {
        solve(node.binary_node, node.row);
      } else {
        combine(node.binary_node, top[node.first_child].row, top[node.first_child + 1].row,
                node.row);
      }
    }
  }

  bool is_leaf(uint32_t binary_node) const { return decisions_[binary_node].get(1) != 0; }

  uint32_t choose(uint32_t binary_node, ChosenSlot* chosen) const {
    const uint32_t count = distribute(binary_node, width_, chosen);
    return fill_from_ <= count ? divide_leaves(*this, chosen, count, width_) : count;
  }

  // For divide_leaves.
  uint32_t left_child(uint32_t index) const { return binary_.nodes[index].first; }
  uint32_t right_child(uint32_t index) const { return binary_.nodes[index].first + 1; }
  float added_weight(uint32_t index) const {
    const BinaryNode& node = binary_.nodes[index];
    if (node.is_leaf()) return std::numeric_limits<float>::infinity();
    return measured_weight_of(node.first) + measured_weight_of(node.first + 1) -
           measured_weight_of(index);
  }

 private:
  /// Subtrees that are solved in parallel: enough to balance what differs in size.
  static constexpr size_t kSubtrees = 512;

  struct TopNode {
    uint32_t binary_node;
    uint32_t first_child;  ///< among the top nodes; 0: not opened
    CostRow row;
  };

  /// Opens nodes breadth first; returns the first one that was not reached.
  size_t open_top(GrowingArray<TopNode>& top) const {
    size_t next = 0;
    for (; next < top.size() && top.size() - next < kSubtrees; ++next) {
      const BinaryNode& node = binary_.nodes[top[next].binary_node];
      if (node.is_leaf()) continue;
      top[next].first_child = static_cast<uint32_t>(top.size());
      top.push_back({node.first, 0, {}});
      top.push_back({node.first + 1, 0, {}});
    }
    return next;
  }

  /// What a node's cost is in proportion to: its area, or the visits that were measured.
  float measured_weight_of(uint32_t index) const {
    return visit_weights_.empty() ? binary_.nodes[index].bounds.half_area() : visit_weights_[index];
  }

  /// With so little added that it decides only among nodes without any weight: there, fewer nodes
  /// and leaves are better.
  double weight_of(uint32_t index) const { return measured_weight_of(index) + least_weight_; }

  void solve(uint32_t index, CostRow& row) {
    const BinaryNode& node = binary_.nodes[index];
    if (node.is_leaf()) {
      row.size = 1;
      row.primitive_count = node.count;
      row.cost[0] = leaf_cost_ * weight_of(index);
      decisions_[index] = Decisions();
      decisions_[index].add(1, 1);
      return;
    }
    CostRow left, right;
    solve(node.first, left);
    solve(node.first + 1, right);
    combine(index, left, right, row);
  }

  void combine(uint32_t index, const CostRow& left, const CostRow& right, CostRow& row) {
    const double weight = weight_of(index);
    const uint32_t size = std::min(left.size + right.size, width_);
    double least[kMaxContractionWidth + 1];
    uint32_t from_left[kMaxContractionWidth + 1];
    for (uint32_t i = 2; i <= size; ++i) least[i] = share(left, right, i, from_left[i]);

    row.primitive_count = std::min(left.primitive_count + right.primitive_count, leaf_width_ + 1);
    const double as_node = least[size] + node_cost_ * weight;
    const double as_leaf = row.primitive_count <= leaf_width_
                               ? leaf_cost_ * weight
                               : std::numeric_limits<double>::infinity();
    Decisions decisions;
    decisions.add(1, as_leaf <= as_node);
    decisions.add(width_, from_left[size]);
    row.cost[0] = std::min(as_leaf, as_node);
    row.size = 1;
    for (uint32_t i = 2; i <= std::min(size, width_ - 1); ++i) {
      row.cost[i - 1] = row.cost[i - 2];
      if (least[i] < row.cost[i - 1]) {
        row.cost[i - 1] = least[i];
        row.size = i;
        decisions.add(i, from_left[i]);
      }
    }
    decisions_[index] = decisions;
  }

  /// The least cost of count children, and how many of them come from the left.
  static double share(const CostRow& left, const CostRow& right, uint32_t count,
                      uint32_t& from_left) {
    const uint32_t first = count > right.size ? count - right.size : 1;
    const uint32_t last = std::min(left.size, count - 1);
    double least = std::numeric_limits<double>::infinity();
    for (uint32_t k = first; k <= last; ++k) {
      const double cost = left.cost[k - 1] + right.cost[count - k - 1];
      if (cost < least) {
        least = cost;
        from_left = k;
      }
    }
    return least;
  }

  /// Writes the at most count children that a node was divided into; returns their number.
  uint32_t distribute(uint32_t index, uint32_t count, ChosenSlot* chosen) const {
    const uint32_t first = binary_.nodes[index].first;
    const uint32_t from_left = decisions_[index].get(count);
    const uint32_t used = collect(first, from_left, chosen);
    return used + collect(first + 1, count - from_left, chosen + used);
  }

  uint32_t collect(uint32_t index, uint32_t count, ChosenSlot* chosen) const {
    while (count > 1 && decisions_[index].get(count) == 0) --count;
    if (count > 1) return distribute(index, count, chosen);
    chosen[0] = {index, is_leaf(index)};
    return 1;
  }

  const BinaryBvh& binary_;
  uint32_t width_;
  uint32_t leaf_width_;
  uint32_t fill_from_;  ///< nodes of at least so many children are filled
  double node_cost_;
  double leaf_cost_;
  std::span<const float> visit_weights_;
  double least_weight_;
  Array<Decisions> decisions_;
};

}  // namespace

Contraction contract_optimally(const BinaryBvh& binary, const OptimalContractionConfig& config,
                               Memory& memory, const Parallel& parallel) {
  OptimalChooser chooser(binary, config, memory);
  chooser.decide(memory, parallel);
  ParallelContraction contraction(binary, chooser, memory, parallel);
  return contraction.run({0, chooser.is_leaf(0)});
}

}  // namespace kiwami
