// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/error.h"
#include "math/rounding.h"
#include "wide/binary_layouts.h"

namespace kiwami {
namespace {

/// Costs of traversal steps, relative to each other: a split or carving node compares two planes, a
/// leaf tests its triangles.
constexpr double kNodeCost = 1.0;
constexpr double kLeafCost = 4.0;

using Side = DualSplitNode::Side;

double area_of(const Bounds& box) { return static_cast<double>(box.half_area()); }

float& bound_of(Bounds& box, Side side) {
  return side.is_upper != 0 ? box.upper[static_cast<int>(side.axis)]
                            : box.lower[static_cast<int>(side.axis)];
}
float bound_of(const Bounds& box, Side side) {
  return side.is_upper != 0 ? box.upper[static_cast<int>(side.axis)]
                            : box.lower[static_cast<int>(side.axis)];
}

/// What a box becomes where one of its sides is moved to that of another.
Bounds carved(Bounds box, const Bounds& to, Side side) {
  bound_of(box, side) = bound_of(to, side);
  return box;
}

void check_room(uint64_t count, uint64_t limit, const char* what) {
  if (count <= limit) return;
  throw Error(KIWAMI_ERROR_TOO_LARGE, "the tree has %llu %s, expected at most %llu",
              static_cast<unsigned long long>(count), what, static_cast<unsigned long long>(limit));
}

/// Leaf blocks are numbered in the order in which they are added.
class BlockWriter {
 public:
  BlockWriter(const FlatBinary& tree, Memory& memory) : tree_(tree), blocks_(memory) {}

  uint32_t add(const kiwami_bvh_node& leaf) {
    IndexBlock<kBinaryBlockWidth> block;
    for (uint32_t lane = 0; lane < kBinaryBlockWidth; ++lane) {
      block.id[lane] = lane < leaf.primitive_count
                           ? tree_.primitive_ids[leaf.first_primitive + lane]
                           : KIWAMI_INVALID_ID;
    }
    blocks_.push_back(block);
    return static_cast<uint32_t>(blocks_.size() - 1);
  }
  Array<IndexBlock<kBinaryBlockWidth>> take() { return blocks_.take(); }

 private:
  const FlatBinary& tree_;
  GrowingArray<IndexBlock<kBinaryBlockWidth>> blocks_;
};

/// Writes a dual-split tree depth first.
class DualSplitWriter {
 public:
  DualSplitWriter(const FlatBinary& tree, Memory& memory)
      : tree_(tree), memory_(memory), nodes_(memory), blocks_(tree, memory) {}

  BinaryLayout run() {
    BinaryLayout layout;
    if (!tree_.nodes.empty()) {
      find_costs();
      layout.bounds = tree_.stored_bounds(0);
      write_all(layout);
    }
    layout.nodes = nodes_.take();
    layout.blocks = blocks_.take();
    return layout;
  }

 private:
  static constexpr uint32_t kNoParent = 0xFFFFFFFFu;

  /// A node to be written, the box that the planes above leave to it, and the split whose upper
  /// child it is.
  struct Task {
    uint32_t node;
    uint32_t split;
    Bounds left;
  };

  /// What a ray that meets the box of a node pays below, by the surface area heuristic.
  void find_costs() {
    costs_ = Array<double>(memory_, tree_.nodes.size());
    for (size_t i = tree_.nodes.size(); i-- > 0;) {
      const kiwami_bvh_node& node = tree_.nodes[i];
      costs_[i] = kLeafCost;
      if (node.child_count == 0) continue;
      const double area = area_of(tree_.stored_bounds(static_cast<uint32_t>(i)));
      costs_[i] = kNodeCost;
      for (uint32_t child = node.first_child; child < node.first_child + 2; ++child) {
        const double share = area > 0.0 ? area_of(tree_.stored_bounds(child)) / area : 1.0;
        costs_[i] += share * costs_[child];
      }
    }
  }

  void write_all(BinaryLayout& layout) {
    Task stack[kMaxWideDepth + 1];
    uint32_t size = 0;
    stack[size++] = {0, kNoParent, layout.bounds};
    while (size != 0) {
      const Task task = stack[--size];
      const auto place = static_cast<uint32_t>(nodes_.size());
      check_room(place, DualSplitNode::kMaxOffset, "nodes");
      if (task.split != kNoParent) nodes_[task.split].header |= (place - task.split) << 4;
      const kiwami_bvh_node& node = tree_.nodes[task.node];
      const Bounds own = tree_.stored_bounds(task.node);
      Bounds left = task.left;
      while (carve(task.node, own, left, layout)) {
      }
      if (node.child_count == 0) continue;
      ++layout.split_count;
      split(node, left, stack, size);
    }
  }

  /// The side whose plane takes most area off, and false where none differs.
  static bool best_side(const Bounds& own, const Bounds& left, Side& best) {
    double least = 0.0;
    bool is_found = false;
    for (uint32_t code = 0; code < 6; ++code) {
      const Side side{code >> 1, code & 1u};
      if (bound_of(own, side) == bound_of(left, side)) continue;
      const double area = area_of(carved(left, own, side));
      if (is_found && area >= least) continue;
      least = area;
      best = side;
      is_found = true;
    }
    return is_found;
  }

  /// Writes a carving node where it pays, or a leaf. False where there is nothing more to carve.
  bool carve(uint32_t number, const Bounds& own, Bounds& left, BinaryLayout& layout) {
    const kiwami_bvh_node& node = tree_.nodes[number];
    const bool is_leaf = node.child_count == 0;
    Side first{}, second{};
    Bounds rest = left;
    const bool is_carved = best_side(own, left, first);
    if (is_carved) {
      rest = carved(rest, own, first);
      second = first;
      if (best_side(own, rest, second)) rest = carved(rest, own, second);
    }
    // A leaf's own two planes cost no node more.
    if (is_leaf && !pays(rest, own, number)) {
      const DualSplitNode::Kind kind =
          is_carved ? DualSplitNode::kCarvedLeaf : DualSplitNode::kLeaf;
      push(kind, own, first, second, add_block(node));
      return false;
    }
    if (!is_leaf && !pays(left, rest, number)) return false;
    push(DualSplitNode::kCarve, own, first, second, 0);
    ++layout.carve_count;
    left = rest;
    return true;
  }

  /// Whether a carving node from one box to another saves more than it costs.
  bool pays(const Bounds& from, const Bounds& to, uint32_t node) const {
    return (area_of(from) - area_of(to)) * costs_[node] > kNodeCost * area_of(from);
  }

  void push(DualSplitNode::Kind kind, const Bounds& own, Side first, Side second, uint32_t block) {
    nodes_.push_back({DualSplitNode::carve_header(kind, first, second, block),
                      {bound_of(own, first), bound_of(own, second)}});
  }

  uint32_t add_block(const kiwami_bvh_node& leaf) {
    const uint32_t block = blocks_.add(leaf);
    check_room(block, DualSplitNode::kMaxBlock, "leaves");
    return block;
  }

  /// Chooses the axis, and which child is the lower one, by what the children's boxes cost that
  /// remain.
  void split(const kiwami_bvh_node& node, const Bounds& left, Task* stack, uint32_t& size) {
    uint32_t best_axis = 0, best_lower = node.first_child;
    Bounds best_boxes[2];
    double least = 0.0;
    for (uint32_t code = 0; code < 6; ++code) {
      const uint32_t axis = code >> 1;
      const uint32_t lower = node.first_child + (code & 1u);
      const uint32_t upper = node.first_child + 1 - (code & 1u);
      const Bounds boxes[2] = {carved(left, tree_.stored_bounds(lower), {axis, 1}),
                               carved(left, tree_.stored_bounds(upper), {axis, 0})};
      const double cost = area_of(boxes[0]) * costs_[lower] + area_of(boxes[1]) * costs_[upper];
      if (code != 0 && cost >= least) continue;
      least = cost;
      best_axis = axis;
      best_lower = lower;
      best_boxes[0] = boxes[0];
      best_boxes[1] = boxes[1];
    }
    const uint32_t upper = 2 * node.first_child + 1 - best_lower;
    const auto place = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back(
        {DualSplitNode::split_header(best_axis, 0),
         {bound_of(best_boxes[0], {best_axis, 1}), bound_of(best_boxes[1], {best_axis, 0})}});
    stack[size++] = {upper, place, best_boxes[1]};
    stack[size++] = {best_lower, kNoParent, best_boxes[0]};
  }

  const FlatBinary& tree_;
  Memory& memory_;
  Array<double> costs_;
  GrowingArray<DualSplitNode> nodes_;
  BlockWriter blocks_;
};

}  // namespace

Bounds FlatBinary::stored_bounds(uint32_t node) const {
  Bounds bounds;
  for (int axis = 0; axis < 3; ++axis) {
    bounds.lower[axis] = subtract_down(nodes[node].lower[axis], centre[axis]);
    bounds.upper[axis] = subtract_up(nodes[node].upper[axis], centre[axis]);
  }
  return bounds;
}

BinaryLayout box_layout(const FlatBinary& tree, Memory& memory) {
  BinaryLayout layout;
  if (tree.nodes.empty()) return layout;
  layout.bounds = tree.stored_bounds(0);
  layout.boxes = Array<BoxNode>(memory, tree.nodes.size());
  BlockWriter blocks(tree, memory);
  for (uint32_t i = 0; i < tree.nodes.size(); ++i) {
    const kiwami_bvh_node& node = tree.nodes[i];
    const bool is_leaf = node.child_count == 0;
    BoxNode& stored = layout.boxes[i];
    const Bounds bounds = tree.stored_bounds(i);
    for (int axis = 0; axis < 3; ++axis) {
      stored.bounds[axis][0] = bounds.lower[axis];
      stored.bounds[axis][1] = bounds.upper[axis];
    }
    stored.first = is_leaf ? blocks.add(node) : node.first_child;
    stored.is_leaf = is_leaf ? 1 : 0;
    layout.split_count += is_leaf ? 0 : 1;
  }
  layout.blocks = blocks.take();
  return layout;
}

BinaryLayout dual_split_layout(const FlatBinary& tree, Memory& memory) {
  return DualSplitWriter(tree, memory).run();
}

}  // namespace kiwami
