// SPDX-License-Identifier: Apache-2.0
#include "bvh/tree_edit.h"

#include <algorithm>
#include <bit>

namespace kiwami {
namespace {

/// The nodes that the root names, itself included. No recursion: the tree may be of any depth.
size_t count_nodes(const BinaryBvh& bvh, Memory& memory) {
  GrowingArray<uint32_t> open(memory);
  open.push_back(0);
  size_t count = 0;
  while (!open.empty()) {
    const BinaryNode& node = bvh.nodes[open.back()];
    open.pop_back();
    ++count;
    if (node.is_leaf()) continue;
    open.push_back(node.first + 1);
    open.push_back(node.first);
  }
  return count;
}

/// What limit_depth needs to know of each node's subtree.
struct Extent {
  uint32_t height;  ///< nodes on the longest path down, the node included
  uint32_t leaf_count;
};

Array<Extent> measure_extents(const BinaryBvh& bvh, Memory& memory) {
  Array<Extent> extents(memory, bvh.nodes.size());
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    const BinaryNode& node = bvh.nodes[i];
    if (node.is_leaf()) {
      extents[i] = {1, 1};
      continue;
    }
    const Extent &left = extents[node.first], &right = extents[node.first + 1];
    extents[i] = {1 + std::max(left.height, right.height), left.leaf_count + right.leaf_count};
  }
  return extents;
}

/// Replaces the inner part of one subtree by halves of its leaves, in the same nodes.
class SubtreeHalving {
 public:
  SubtreeHalving(BinaryBvh& bvh, Memory& memory)
      : bvh_(bvh), memory_(memory), leaves_(memory), pairs_(memory) {}

  void run(uint32_t root) {
    collect(root);
    halve(root, 0, static_cast<uint32_t>(leaves_.size()));
  }

 private:
  void collect(uint32_t root) {
    GrowingArray<uint32_t> open(memory_);
    open.push_back(root);
    while (!open.empty()) {
      const BinaryNode& node = bvh_.nodes[open.back()];
      open.pop_back();
      if (node.is_leaf()) {
        leaves_.push_back(node);
        continue;
      }
      pairs_.push_back(node.first);
      open.push_back(node.first + 1);
      open.push_back(node.first);
    }
  }

  void halve(uint32_t target, uint32_t begin, uint32_t end) {
    if (end - begin == 1) {
      bvh_.nodes[target] = leaves_[begin];
      return;
    }
    const uint32_t first = pairs_.back();
    pairs_.pop_back();
    const uint32_t middle = begin + (end - begin + 1) / 2;
    halve(first, begin, middle);
    halve(first + 1, middle, end);
    Bounds bounds = bvh_.nodes[first].bounds;
    bounds.extend(bvh_.nodes[first + 1].bounds);
    bvh_.nodes[target] = {bounds, first, 0};
  }

  BinaryBvh& bvh_;
  Memory& memory_;
  GrowingArray<BinaryNode> leaves_;
  GrowingArray<uint32_t> pairs_;  ///< where siblings stood
};

/// The levels of halving count leaves below a node, itself not included.
uint32_t halving_levels(uint32_t count) { return static_cast<uint32_t>(std::bit_width(count - 1)); }

}  // namespace

void relabel_depth_first(BinaryBvh& bvh, Memory& memory) {
  if (bvh.nodes.empty()) return;
  struct Move {
    uint32_t from, to;
  };
  Array<BinaryNode> nodes(memory, count_nodes(bvh, memory));
  Array<uint32_t> ids(memory, bvh.primitive_ids.size());
  GrowingArray<Move> open(memory);
  open.push_back({0, 0});
  uint32_t next_node = 1, next_id = 0;
  while (!open.empty()) {
    const Move move = open.back();
    open.pop_back();
    BinaryNode node = bvh.nodes[move.from];
    if (node.is_leaf()) {
      std::copy_n(bvh.primitive_ids.begin() + node.first, node.count, ids.begin() + next_id);
      node.first = next_id;
      next_id += node.count;
    } else {
      open.push_back({node.first + 1, next_node + 1});
      open.push_back({node.first, next_node});
      node.first = next_node;
      next_node += 2;
    }
    nodes[move.to] = node;
  }
  bvh.nodes = std::move(nodes);
  bvh.primitive_ids = std::move(ids);
}

void limit_depth(BinaryBvh& bvh, Memory& memory) {
  if (bvh.nodes.empty()) return;
  const Array<Extent> extents = measure_extents(bvh, memory);
  if (extents[0].height <= BinaryBvh::kMaxDepth) return;
  struct Open {
    uint32_t node, depth;
  };
  GrowingArray<Open> open(memory);
  open.push_back({0, 1});
  while (!open.empty()) {
    const Open top = open.back();
    open.pop_back();
    const Extent& extent = extents[top.node];
    if (top.depth - 1 + extent.height <= BinaryBvh::kMaxDepth) continue;
    // Whoever comes here has a level to spare: its parent stood above this limit.
    if (top.depth + halving_levels(extent.leaf_count) >= BinaryBvh::kMaxDepth) {
      SubtreeHalving(bvh, memory).run(top.node);
      continue;
    }
    const uint32_t first = bvh.nodes[top.node].first;
    open.push_back({first, top.depth + 1});
    open.push_back({first + 1, top.depth + 1});
  }
  relabel_depth_first(bvh, memory);
}

void collapse_leaves(BinaryBvh& bvh, uint32_t max_leaf_size, const SahCosts& costs,
                     Memory& memory) {
  /// The least cost of a subtree, and its primitives, which stand side by side.
  struct Subtree {
    double cost;
    uint32_t first, count;
  };
  if (bvh.nodes.empty()) return;
  Array<Subtree> subtrees(memory, bvh.nodes.size());
  for (size_t i = bvh.nodes.size(); i-- > 0;) {
    BinaryNode& node = bvh.nodes[i];
    const double leaf_cost = costs.leaf_cost * static_cast<double>(node.bounds.half_area());
    if (node.is_leaf()) {
      subtrees[i] = {leaf_cost * costs.blocks_of(node.count), node.first, node.count};
      continue;
    }
    const Subtree &left = subtrees[node.first], &right = subtrees[node.first + 1];
    const double as_node =
        costs.node_cost * static_cast<double>(node.bounds.half_area()) + left.cost + right.cost;
    subtrees[i] = {as_node, left.first, left.count + right.count};
    const double as_leaf = leaf_cost * costs.blocks_of(subtrees[i].count);
    if (subtrees[i].count > max_leaf_size || as_leaf > as_node) continue;
    subtrees[i].cost = as_leaf;
    node.first = subtrees[i].first;
    node.count = subtrees[i].count;
  }
  relabel_depth_first(bvh, memory);
}

}  // namespace kiwami
