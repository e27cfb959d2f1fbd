// SPDX-License-Identifier: Apache-2.0
// A binary tree that one thread holds while it writes the wide nodes of a part.
#pragma once

#include <algorithm>

#include "bvh/binary_bvh.h"
#include "wide/cluster_costs.h"
#include "wide/wide_parts.h"

namespace kiwami {

/// A tree of which children stand after their parents, and what the dynamic programme knows of its
/// nodes. Its leaves own primitives, or each is a cluster of the level below: number first.
template <int N>
class CostedTree {
 public:
  /// Solves the programme for a root and the nodes below it, which it refers to. The root is the
  /// tree of number root().
  CostedTree(const ClusterPrices& prices, const BinaryNode& root, const BinaryNode* nodes,
             uint32_t node_count, const uint32_t* ids, const WideCluster* clusters, Memory& memory)
      : prices_(prices),
        root_node_(root),
        nodes_(nodes),
        node_count_(node_count),
        ids_(ids),
        clusters_(clusters),
        traits_(memory, size_t{node_count} + 1),
        rows_(memory, size_t{node_count} + 1) {
    for (uint32_t i = node_count; i-- > 0;) solve(i);
    solve(node_count);
  }

  uint32_t root() const { return node_count_; }
  Bounds box_of(uint32_t tree) const { return node_of(tree).bounds; }
  uint32_t left_child(uint32_t tree) const { return node_of(tree).first; }
  uint32_t right_child(uint32_t tree) const { return node_of(tree).first + 1; }
  bool is_leaf(uint32_t tree) const { return traits_[tree].is_leaf; }
  bool is_cluster(uint32_t tree) const { return clusters_ && node_of(tree).is_leaf(); }
  uint32_t cluster_of(uint32_t tree) const { return node_of(tree).first; }
  const CostRow<N>& costs_of(uint32_t tree) const { return rows_[tree]; }
  uint32_t size_of(uint32_t tree) const { return traits_[tree].size; }

  uint32_t* copy_primitives(uint32_t tree, uint32_t* ids) const {
    const BinaryNode& node = node_of(tree);
    if (node.is_leaf()) return std::copy_n(ids_ + node.first, node.count, ids);
    return copy_primitives(node.first + 1, copy_primitives(node.first, ids));
  }

  float added_weight(uint32_t tree) const {
    const BinaryNode& node = node_of(tree);
    if (node.is_leaf()) return std::numeric_limits<float>::infinity();
    return nodes_[node.first].bounds.half_area() + nodes_[node.first + 1].bounds.half_area() -
           node.bounds.half_area();
  }

 private:
  const BinaryNode& node_of(uint32_t tree) const {
    return tree == node_count_ ? root_node_ : nodes_[tree];
  }

  void solve(uint32_t tree) {
    const BinaryNode& node = node_of(tree);
    CostRow<N>& row = rows_[tree];
    row.clear();
    if (!node.is_leaf()) {
      const uint32_t left = node.first, right = node.first + 1;
      traits_[tree] = join_clusters(prices_, prices_.weight_of(node.bounds.half_area()),
                                    rows_[left], traits_[left], rows_[right], traits_[right], row);
    } else if (clusters_) {
      traits_[tree] = {ClusterTraits::kNoLeaf, 1, false};
      row.set_all(clusters_[node.first].cost);
    } else {
      traits_[tree] = {static_cast<uint8_t>(node.count), 1, true};
      row.set_all(prices_.leaf_cost * prices_.weight_of(node.bounds.half_area()));
    }
  }

  ClusterPrices prices_;
  BinaryNode root_node_;
  const BinaryNode* nodes_;
  uint32_t node_count_;
  const uint32_t* ids_;          ///< of primitives, where leaves own any
  const WideCluster* clusters_;  ///< that the leaves are; nullptr: they own primitives
  Array<ClusterTraits> traits_;  ///< by node, then the root's
  Array<CostRow<N>> rows_;
};

}  // namespace kiwami
