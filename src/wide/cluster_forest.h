// SPDX-License-Identifier: Apache-2.0
// The binary trees of one block of the bottom-up builder: clusters join until few are left.
#pragma once

#include "builders/nearest_places.h"
#include "builders/sah_bins.h"
#include "bvh/binary_bvh.h"
#include "wide/cluster_costs.h"
#include "wide/wide_bottom_up.h"

namespace kiwami {

/// Clusters that were joined, and what the dynamic programme knows of them. Numbers below
/// leaf_count() are the clusters that the block began with.
template <int N>
class ClusterForest {
 public:
  ClusterForest(const WideBottomUpConfig& config, double root_area, uint32_t capacity,
                Memory& memory)
      : radius_(config.radius),
        prices_(config.node_cost, config.leaf_cost, config.leaf_width, root_area),
        nearest_(memory, capacity),
        at_place_(memory, capacity),
        trees_(memory, size_t{2} * capacity),
        traits_(memory, size_t{2} * capacity),
        rows_(memory, size_t{2} * capacity) {
    for (CostRow<N>& row : rows_) row.clear();
  }

  /// Starts anew. The first subtree that is added is the cluster of this number, and so on.
  void clear(uint32_t first_cluster = 0) {
    first_cluster_ = first_cluster;
    place_count_ = tree_count_ = leaf_count_ = 0;
  }

  /// Adds a primitive, which costs as much as a leaf.
  void add_primitive(const BuildPrimitive& primitive) {
    add({primitive.lower, primitive.id, primitive.upper, 0}, {1, 1, true},
        prices_.leaf_cost * weight_of(VectorBounds::of(primitive)));
  }

  /// Adds a finished subtree: one child, whatever is around it.
  void add_subtree(const Bounds& box, float cost) {
    add({box.lower, 0, box.upper, 0}, {ClusterTraits::kNoLeaf, 1, false}, cost);
  }

  /// Joins all pairs that are each other's nearest, again and again, until at most target clusters
  /// are left; then tree_at(0), tree_at(1), ... tell which.
  void join_nearest(uint32_t target) {
    // Usually a third and more of the clusters join in each round. Where boxes lie in each other,
    // it may be one pair: that is not done for ever.
    uint64_t work = uint64_t{place_count_} * 16;
    while (place_count_ > target) {
      if (work < place_count_) return join_neighbours(target);
      work -= place_count_;
      nearest_.find(place_count_, radius_);
      join_mutual();
    }
  }

  /// Forgets all pairs and joins neighbours only, so that the tree is as flat as it can be.
  void join_evenly(uint32_t target) {
    tree_count_ = place_count_ = leaf_count_;
    for (uint32_t i = 0; i < leaf_count_; ++i) put(i, i);
    join_neighbours(target);
  }

  uint32_t place_count() const { return place_count_; }
  uint32_t tree_at(uint32_t place) const { return at_place_[place]; }
  uint32_t leaf_count() const { return leaf_count_; }
  Bounds box_of(uint32_t tree) const { return {trees_[tree].lower, trees_[tree].upper}; }
  uint32_t left_child(uint32_t tree) const { return trees_[tree].left; }
  uint32_t right_child(uint32_t tree) const { return trees_[tree].right; }
  /// The primitive that was added as this number.
  uint32_t primitive_id(uint32_t leaf) const { return trees_[leaf].left; }
  /// Whether a tree is one of the finished subtrees, and its number among all clusters.
  bool is_cluster(uint32_t tree) const { return tree < leaf_count_ && !is_leaf(tree); }
  uint32_t cluster_of(uint32_t tree) const { return first_cluster_ + tree; }
  /// Whether a tree is a leaf of primitives where it becomes one child.
  bool is_leaf(uint32_t tree) const { return traits_[tree].is_leaf; }
  const CostRow<N>& costs_of(uint32_t tree) const { return rows_[tree]; }
  /// More children than these do not lower its cost.
  uint32_t size_of(uint32_t tree) const { return traits_[tree].size; }

  uint32_t* copy_primitives(uint32_t tree, uint32_t* ids) const {
    if (tree < leaf_count_) {
      *ids = primitive_id(tree);
      return ids + 1;
    }
    return copy_primitives(right_child(tree), copy_primitives(left_child(tree), ids));
  }

  float added_weight(uint32_t tree) const {
    if (tree < leaf_count_) return std::numeric_limits<float>::infinity();
    return box_of(left_child(tree)).half_area() + box_of(right_child(tree)).half_area() -
           box_of(tree).half_area();
  }

 private:
  /// Two children, or a primitive. Two vectors for VectorBounds, whose fourth lanes hold numbers.
  struct Tree {
    Vec3f lower;
    uint32_t left;  ///< or the id of a primitive
    Vec3f upper;
    uint32_t right;
  };
  static_assert(sizeof(Tree) == sizeof(BuildPrimitive));

  VectorBounds bounds_of(const Tree& tree) const {
    return {simde_mm_loadu_ps(&tree.lower.x), simde_mm_loadu_ps(&tree.upper.x)};
  }

  float weight_of(const VectorBounds& box) const { return prices_.weight_of(box.half_area()); }

  void put(uint32_t place, uint32_t tree) {
    at_place_[place] = tree;
    nearest_.set(place, trees_[tree].lower, trees_[tree].upper);
  }

  void add(const Tree& tree, ClusterTraits traits, float cost) {
    trees_[tree_count_] = tree;
    traits_[tree_count_] = traits;
    rows_[tree_count_].set_all(cost);
    put(place_count_++, tree_count_++);
    ++leaf_count_;
  }

  void join_mutual() {
    uint32_t next = 0;
    for (uint32_t i = 0; i < place_count_; ++i) {
      if (!nearest_.is_mutual(i)) {
        at_place_[next] = at_place_[i];
        nearest_.move(i, next++);
        continue;
      }
      const uint32_t other = nearest_.nearest(i);
      if (i < other) join(i, other, next++);
    }
    place_count_ = next;
  }

  void join_neighbours(uint32_t target) {
    while (place_count_ > target) {
      const uint32_t pairs = place_count_ / 2;
      for (uint32_t i = 0; i < pairs; ++i) join(2 * i, 2 * i + 1, i);
      if (place_count_ % 2 != 0) put(pairs, at_place_[2 * pairs]);
      place_count_ -= pairs;
    }
  }

  void join(uint32_t place, uint32_t other, uint32_t to) {
    const uint32_t left = at_place_[place], right = at_place_[other];
    VectorBounds box = bounds_of(trees_[left]);
    box.extend(bounds_of(trees_[right]));
    Tree& tree = trees_[tree_count_];
    simde_mm_storeu_ps(&tree.lower.x, box.lower);
    simde_mm_storeu_ps(&tree.upper.x, box.upper);
    tree.left = left;
    tree.right = right;
    traits_[tree_count_] = join_clusters(prices_, weight_of(box), rows_[left], traits_[left],
                                         rows_[right], traits_[right], rows_[tree_count_]);
    put(to, tree_count_++);
  }

  uint32_t radius_;
  ClusterPrices prices_;
  NearestPlaces nearest_;
  Array<uint32_t> at_place_;
  Array<Tree> trees_;
  Array<ClusterTraits> traits_;  ///< by tree
  Array<CostRow<N>> rows_;
  uint32_t place_count_ = 0;
  uint32_t tree_count_ = 0;
  uint32_t leaf_count_ = 0;
  uint32_t first_cluster_ = 0;
};

}  // namespace kiwami
