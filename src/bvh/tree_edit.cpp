// SPDX-License-Identifier: Apache-2.0
#include "bvh/tree_edit.h"

#include <algorithm>
#include <bit>
#include <utility>

namespace kiwami {
namespace {

/// No node comes from here, or it has moved already.
constexpr uint32_t kMoved = ~0u;

/// Moves node i to place moves_to[i], without a second array of nodes. What no node moves to is
/// overwritten or stays as it is.
void move_nodes(Array<BinaryNode>& nodes, Array<uint32_t>& moves_to) {
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    BinaryNode carried = nodes[i];
    // Whoever stood where one was put is the next to move.
    for (uint32_t to = std::exchange(moves_to[i], kMoved); to != kMoved;) {
      std::swap(carried, nodes[to]);
      to = std::exchange(moves_to[to], kMoved);
    }
  }
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

/// The least cost of a subtree, and its primitives, which stand side by side.
struct Collapsed {
  double cost;
  uint32_t first, count;
};

// Recursive: no tree is deeper than BinaryBvh::kMaxDepth.
Collapsed collapse_below(BinaryBvh& bvh, uint32_t index, uint32_t max_leaf_size,
                         const SahCosts& costs) {
  BinaryNode& node = bvh.nodes[index];
  const double leaf_cost = costs.leaf_cost * static_cast<double>(node.bounds.half_area());
  if (node.is_leaf()) return {leaf_cost * costs.blocks_of(node.count), node.first, node.count};
  const Collapsed left = collapse_below(bvh, node.first, max_leaf_size, costs);
  const Collapsed right = collapse_below(bvh, node.first + 1, max_leaf_size, costs);
  const uint32_t count = left.count + right.count;
  const double as_node =
      costs.node_cost * static_cast<double>(node.bounds.half_area()) + left.cost + right.cost;
  const double as_leaf = leaf_cost * costs.blocks_of(count);
  if (count > max_leaf_size || as_leaf > as_node) return {as_node, left.first, count};
  node.first = left.first;
  node.count = count;
  return {as_leaf, left.first, count};
}

}  // namespace

void relabel_depth_first(BinaryBvh& bvh, Memory& memory) {
  if (bvh.nodes.empty()) return;
  Array<uint32_t> moves_to(memory, bvh.nodes.size());
  std::fill(moves_to.begin(), moves_to.end(), kMoved);
  Array<uint32_t> ids(memory, bvh.primitive_ids.size());
  // No recursion: the tree may be of any depth.
  GrowingArray<uint32_t> open(memory);
  open.push_back(0);
  moves_to[0] = 0;
  uint32_t next_node = 1, next_id = 0;
  while (!open.empty()) {
    BinaryNode& node = bvh.nodes[open.back()];
    open.pop_back();
    const uint32_t first = node.first;
    if (node.is_leaf()) {
      std::copy_n(bvh.primitive_ids.begin() + first, node.count, ids.begin() + next_id);
      node.first = next_id;
      next_id += node.count;
      continue;
    }
    node.first = moves_to[first] = next_node;
    moves_to[first + 1] = next_node + 1;
    next_node += 2;
    open.push_back(first + 1);
    open.push_back(first);
  }
  bvh.primitive_ids = std::move(ids);
  move_nodes(bvh.nodes, moves_to);
  moves_to = {};
  bvh.nodes.shrink(next_node);
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
  if (bvh.nodes.empty()) return;
  collapse_below(bvh, 0, max_leaf_size, costs);
  relabel_depth_first(bvh, memory);
}

}  // namespace kiwami
