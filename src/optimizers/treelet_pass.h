// SPDX-License-Identifier: Apache-2.0
// What all restructuring of treelets shares: the walk over a tree from below, with the top of each
// subtree, its treelet, given a new shape over the same subtrees.
#pragma once

#include <algorithm>

#include "bvh/tree_edit.h"
#include "parallel/parallel.h"

namespace kiwami {

struct TreeletConfig {
  /// What a treelet stands on: so many subtrees, 3 to kMaxTreeletLeaves (optimal shapes: to 8).
  uint32_t leaf_count = 7;
  /// Passes over the tree. The least subtree that is restructured owns leaf_count leaves in the
  /// first and twice as many in each that follows: what lies deep is settled by the first.
  uint32_t rounds = 3;
  SahCosts costs = {};
  /// A subtree may be counted as a leaf up to so many primitives.
  uint32_t max_leaf_size = 8;
};

constexpr uint32_t kMaxTreeletLeaves = 20;

/// What is known of a subtree.
struct TreeletCluster {
  Bounds bounds;
  uint32_t leaf_count;
  uint32_t primitive_count;
  double cost;  ///< as a node or as a leaf, whichever is less
};

/// Two clusters that become siblings: a treelet's leaves are 0 to n - 1, join k makes cluster n +
/// k.
struct Join {
  uint32_t left, right;
};

class ClusterCosts {
 public:
  explicit ClusterCosts(const TreeletConfig& config)
      : costs_(config.costs), max_leaf_size_(config.max_leaf_size) {}

  TreeletCluster leaf(const BinaryNode& node) const {
    return {node.bounds, 1, node.count, as_leaf(node.bounds.half_area(), node.count)};
  }

  TreeletCluster joined(const TreeletCluster& left, const TreeletCluster& right) const {
    TreeletCluster made = {left.bounds, left.leaf_count + right.leaf_count,
                           left.primitive_count + right.primitive_count, 0.0};
    made.bounds.extend(right.bounds);
    made.cost = of(made.bounds.half_area(), made.primitive_count, left.cost + right.cost);
    return made;
  }

  /// Of a subtree with children of a known cost.
  double of(double area, uint32_t primitive_count, double below) const {
    const double as_node = costs_.node_cost * area + below;
    if (primitive_count > max_leaf_size_) return as_node;
    return std::min(as_node, as_leaf(area, primitive_count));
  }

 private:
  double as_leaf(double area, uint32_t primitive_count) const {
    return costs_.leaf_cost * area * costs_.blocks_of(primitive_count);
  }

  SahCosts costs_;
  uint32_t max_leaf_size_;
};

/// Shaper has
///   bool shape(const TreeletCluster* leaves, uint32_t count, double cost, Join* joins) const
/// which finds the count - 1 joins of a treelet, the root's last, and returns whether they cost
/// less than the given shape. Every subtree is restructured after those below it, so the tree is
/// the same for any number of threads.
template <typename Shaper>
class TreeletPass {
 public:
  TreeletPass(BinaryBvh& bvh, const TreeletConfig& config, const Shaper& shaper, Memory& memory)
      : bvh_(bvh),
        config_(config),
        costs_(config),
        shaper_(shaper),
        memory_(memory),
        clusters_(memory, bvh.nodes.size()) {}

  void run(const Parallel& parallel) {
    uint32_t least = config_.leaf_count;
    for (uint32_t round = 0; round < config_.rounds; ++round, least *= 2)
      run_round(least, parallel);
  }

 private:
  /// Subtrees that are worked on in parallel: enough to balance what differs in size.
  static constexpr size_t kSubtrees = 512;

  void run_round(uint32_t least, const Parallel& parallel) {
    GrowingArray<uint32_t> top(memory_);
    top.push_back(0);
    size_t opened = 0;
    for (; opened < top.size() && top.size() - opened < kSubtrees; ++opened) {
      const BinaryNode& node = bvh_.nodes[top[opened]];
      if (node.is_leaf()) continue;
      top.push_back(node.first);
      top.push_back(node.first + 1);
    }
    parallel.for_each(top.size() - opened,
                      [&](size_t i) { restructure_below(top[opened + i], least); });
    // Breadth first: children stand behind their parents. Leaves among them have nothing below.
    for (size_t i = opened; i-- > 0;) restructure(top[i], least);
  }

  void restructure_below(uint32_t slot, uint32_t least) {
    const BinaryNode& node = bvh_.nodes[slot];
    if (!node.is_leaf()) {
      restructure_below(node.first, least);
      restructure_below(node.first + 1, least);
    }
    restructure(slot, least);
  }

  void restructure(uint32_t slot, uint32_t least) {
    const BinaryNode& node = bvh_.nodes[slot];
    if (node.is_leaf()) {
      clusters_[slot] = costs_.leaf(node);
      return;
    }
    clusters_[slot] = costs_.joined(clusters_[node.first], clusters_[node.first + 1]);
    if (clusters_[slot].leaf_count < least) return;
    Treelet treelet;
    form(slot, treelet);
    Join joins[kMaxTreeletLeaves];
    if (!shaper_.shape(treelet.leaves, treelet.size, clusters_[slot].cost, joins)) return;
    treelet.joins = joins;
    place(slot, 2 * treelet.size - 2, treelet);
  }

  struct Treelet {
    uint32_t size = 0;
    uint32_t pairs_used = 0;
    TreeletCluster leaves[kMaxTreeletLeaves];
    BinaryNode nodes[kMaxTreeletLeaves];  ///< of the leaves
    uint32_t pairs[kMaxTreeletLeaves];    ///< where siblings stand
    const Join* joins;
  };

  /// Opens the largest of the nodes that can be opened until there are enough.
  void form(uint32_t root, Treelet& treelet) const {
    const auto add = [&](uint32_t place, uint32_t slot) {
      treelet.nodes[place] = bvh_.nodes[slot];
      treelet.leaves[place] = clusters_[slot];
    };
    uint32_t first = bvh_.nodes[root].first;
    add(0, first);
    add(1, first + 1);
    treelet.pairs[0] = first;
    treelet.size = 2;
    while (treelet.size < config_.leaf_count) {
      uint32_t best = treelet.size;
      float largest = -1.0f;
      for (uint32_t i = 0; i < treelet.size; ++i) {
        const float area = treelet.nodes[i].bounds.half_area();
        if (treelet.nodes[i].is_leaf() || area <= largest) continue;
        largest = area;
        best = i;
      }
      if (best == treelet.size) return;
      first = treelet.nodes[best].first;
      add(best, first);
      add(treelet.size, first + 1);
      treelet.pairs[treelet.size - 1] = first;
      ++treelet.size;
    }
  }

  /// Writes a cluster of the treelet to a slot, and what is below it to the pairs, in order.
  void place(uint32_t slot, uint32_t cluster, Treelet& treelet) {
    if (cluster < treelet.size) {
      bvh_.nodes[slot] = treelet.nodes[cluster];
      clusters_[slot] = treelet.leaves[cluster];
      return;
    }
    const Join& join = treelet.joins[cluster - treelet.size];
    const uint32_t first = treelet.pairs[treelet.pairs_used++];
    place(first, join.left, treelet);
    place(first + 1, join.right, treelet);
    clusters_[slot] = costs_.joined(clusters_[first], clusters_[first + 1]);
    bvh_.nodes[slot] = {clusters_[slot].bounds, first, 0};
  }

  BinaryBvh& bvh_;
  TreeletConfig config_;
  ClusterCosts costs_;
  const Shaper& shaper_;
  Memory& memory_;
  Array<TreeletCluster> clusters_;  ///< by slot
};

}  // namespace kiwami
