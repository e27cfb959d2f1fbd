// SPDX-License-Identifier: Apache-2.0
// From the binary trees that are known while a part is built to its wide nodes.
#pragma once

#include "wide/chosen_slots.h"
#include "wide/cluster_costs.h"
#include "wide/part_arrays.h"

namespace kiwami {

/// Writes the trees of one forest after the other. Forest has, for each tree of it,
///   Bounds box_of(tree); uint32_t left_child(tree), right_child(tree)
///   bool is_leaf(tree): a leaf of primitives where it becomes one child
///   bool is_cluster(tree): one of the level below, of which cluster_of(tree) is the number
///   const CostRow<N>& costs_of(tree); uint32_t size_of(tree): more children do not lower its cost
///   uint32_t* copy_primitives(tree, ids): writes the ids of all primitives; returns their end
///   float added_weight(tree): for divide_leaves
template <int N, typename Forest>
class ForestWriter {
 public:
  /// For parts of at most capacity leaves. The clusters are those of the level below.
  ForestWriter(const Forest& forest, const WideCluster* clusters, bool fill_nodes,
               uint32_t capacity, Memory& memory)
      : forest_(forest),
        clusters_(clusters),
        fill_from_(fill_nodes ? N / 2 + 2 : N),
        arrays_(capacity, 2 * capacity, capacity, memory) {}

  /// Starts a part. Primitives are written to ids, leaf by leaf.
  void start(uint32_t* ids) { arrays_.start(ids); }

  WideCluster write(uint32_t tree, uint32_t part) {
    WideCluster cluster = {forest_.box_of(tree), forest_.costs_of(tree).of(1), 0, part, 0};
    cluster.child = write_child(tree);
    if (forest_.is_cluster(tree)) {
      cluster = clusters_[forest_.cluster_of(tree)];
    } else if (!forest_.is_leaf(tree)) {
      cluster.height = expand(tree, cluster.child);
    }
    return cluster;
  }

  /// The children of least cost that a tree has if it becomes a node; returns their number.
  uint32_t choose(uint32_t tree, ChosenSlot* chosen) const { return distribute(tree, N, chosen); }

  WidePart take(Memory& memory) const { return arrays_.take(memory); }

 private:
  /// Gives an inner child its number, writes a leaf; returns the reference to it.
  uint32_t write_child(uint32_t tree) {
    if (forest_.is_leaf(tree)) return write_leaf(tree);
    if (forest_.is_cluster(tree)) return kClusterFlag | forest_.cluster_of(tree);
    arrays_.add_node_area(forest_.box_of(tree).half_area());
    return arrays_.add_node();
  }

  /// Writes a node and all below it; returns the height.
  uint32_t expand(uint32_t tree, uint32_t node) {
    ChosenSlot chosen[N];
    uint32_t count = choose(tree, chosen);
    if (fill_from_ <= count) count = divide_leaves(forest_, chosen, count, N);
    const uint32_t first = arrays_.add_slots(node, count);
    for (uint32_t i = 0; i < count; ++i) {
      const uint32_t child = chosen[i].binary_node;
      arrays_.set_slot(first + i, forest_.box_of(child),
                       chosen[i].is_leaf ? write_leaf(child) : write_child(child));
    }
    uint32_t height = 0;
    for (uint32_t i = 0; i < count; ++i) {
      const uint32_t child = chosen[i].binary_node;
      if (chosen[i].is_leaf) continue;
      height =
          std::max(height, forest_.is_cluster(child) ? clusters_[forest_.cluster_of(child)].height
                                                     : expand(child, arrays_.child(first + i)));
    }
    return height + 1;
  }

  /// Writes the at most count children that a tree is divided into; returns their number.
  uint32_t distribute(uint32_t tree, uint32_t count, ChosenSlot* chosen) const {
    const uint32_t left = forest_.left_child(tree), right = forest_.right_child(tree);
    const CostRow<N>&left_costs = forest_.costs_of(left), &right_costs = forest_.costs_of(right);
    const uint32_t left_size = forest_.size_of(left), right_size = forest_.size_of(right);
    count = std::min(count, left_size + right_size);
    uint32_t from_left = count > right_size ? count - right_size : 1;
    float least = left_costs.of(from_left) + right_costs.of(count - from_left);
    for (uint32_t k = from_left + 1; k <= std::min(left_size, count - 1); ++k) {
      const float cost = left_costs.of(k) + right_costs.of(count - k);
      if (cost < least) {
        least = cost;
        from_left = k;
      }
    }
    const uint32_t used = collect(left, from_left, chosen);
    return used + collect(right, count - from_left, chosen + used);
  }

  uint32_t collect(uint32_t tree, uint32_t count, ChosenSlot* chosen) const {
    const CostRow<N>& costs = forest_.costs_of(tree);
    // Where fewer children cost as little, there are fewer.
    while (count > 1 && costs.of(count) == costs.of(count - 1)) --count;
    if (count > 1) return distribute(tree, count, chosen);
    chosen[0] = {tree, forest_.is_leaf(tree)};
    return 1;
  }

  uint32_t write_leaf(uint32_t tree) {
    uint32_t* const end = forest_.copy_primitives(tree, arrays_.ids());
    return arrays_.add_leaf(end, forest_.box_of(tree).half_area());
  }

  const Forest& forest_;
  const WideCluster* clusters_;
  uint32_t fill_from_;  ///< nodes of at least so many children are filled
  PartArrays arrays_;
};

}  // namespace kiwami
