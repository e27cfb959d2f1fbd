// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/error.h"
#include "wide/binary_layouts.h"

namespace kiwami {
namespace {

[[noreturn]] void fail(uint32_t node, const char* what) {
  throw Error(KIWAMI_ERROR_VALIDATION, "node %u of the binary tree %s", node, what);
}

/// Walks through a layout with the box that is left of space at each node.
class LayoutVerifier {
 public:
  LayoutVerifier(const BinaryLayout& layout, const PrimitiveBoxes& primitives, Memory& memory)
      : layout_(layout),
        primitives_(primitives),
        is_block_seen_(memory, layout.blocks.size()),
        is_id_seen_(memory, primitives.by_id.size()) {
    is_block_seen_.fill_zero();
    is_id_seen_.fill_zero();
  }

  void run() {
    if (layout_.node_count() != 0) {
      stack_[size_++] = {0, layout_.bounds};
      while (size_ != 0) {
        const Task task = stack_[--size_];
        if (layout_.boxes.empty()) {
          visit_planes(task);
        } else {
          visit_box(task);
        }
      }
    }
    if (visited_ != layout_.node_count()) fail(visited_, "is reached from nowhere");
    for (size_t i = 0; i < primitives_.by_id.size(); ++i) {
      if (is_id_seen_[i] != 0 || primitives_.by_id[i].is_empty()) continue;
      throw Error(KIWAMI_ERROR_VALIDATION, "triangle %zu stands in no leaf of the binary tree", i);
    }
  }

 private:
  struct Task {
    uint32_t node;
    Bounds left;
  };

  void push(uint32_t node, const Bounds& left) {
    if (size_ == kMaxWideDepth + 1) fail(node, "lies deeper than a traversal stack holds");
    stack_[size_++] = {node, left};
  }

  void visit_box(const Task& task) {
    if (task.node >= layout_.boxes.size()) fail(task.node, "is not there");
    ++visited_;
    const BoxNode& node = layout_.boxes[task.node];
    Bounds own;
    for (int axis = 0; axis < 3; ++axis) {
      own.lower[axis] = node.bounds[axis][0];
      own.upper[axis] = node.bounds[axis][1];
    }
    if (!task.left.contains(own)) fail(task.node, "reaches out of its parent's box");
    if (node.is_leaf != 0) return visit_block(task.node, node.first, own);
    if (node.first <= task.node) fail(task.node, "stands behind its children");
    push(node.first + 1, own);
    push(node.first, own);
  }

  /// A side may be cut, never moved outwards.
  void cut(uint32_t number, Bounds& left, DualSplitNode::Side side, float plane) const {
    const int axis = static_cast<int>(side.axis);
    if (axis > 2) fail(number, "has planes along a fourth axis");
    float& bound = side.is_upper != 0 ? left.upper[axis] : left.lower[axis];
    const bool is_cut = side.is_upper != 0 ? plane <= bound : plane >= bound;
    if (!is_cut) fail(number, "has a plane beyond what is left to it");
    bound = plane;
  }

  void visit_planes(const Task& task) {
    // Depth first: nodes are met in the order in which they stand.
    if (task.node != visited_) fail(task.node, "does not stand where depth-first order has it");
    if (task.node >= layout_.nodes.size()) fail(task.node, "is not there");
    ++visited_;
    const DualSplitNode& node = layout_.nodes[task.node];
    Bounds left = task.left;
    if (node.kind() == DualSplitNode::kSplit) {
      Bounds upper = left;
      cut(task.node, left, {node.axis(), 1}, node.plane[0]);
      cut(task.node, upper, {node.axis(), 0}, node.plane[1]);
      push(task.node + node.upper_offset(), upper);
      push(task.node + 1, left);
      return;
    }
    if (node.kind() != DualSplitNode::kLeaf) {
      for (int k = 0; k < 2; ++k) cut(task.node, left, node.side(k), node.plane[k]);
    }
    if (!node.is_leaf()) return push(task.node + 1, left);
    visit_block(task.node, node.block(), left);
  }

  void visit_block(uint32_t node, uint32_t block, const Bounds& left) {
    if (block >= layout_.blocks.size()) fail(node, "has a block of triangles that is not there");
    if (is_block_seen_[block]++ != 0) fail(node, "has the triangles of another leaf");
    for (const uint32_t id : layout_.blocks[block].id) {
      if (id == KIWAMI_INVALID_ID) continue;
      if (id >= primitives_.by_id.size()) fail(node, "has a triangle that is not there");
      if (is_id_seen_[id] != 0 && !primitives_.has_duplicates) {
        fail(node, "has a triangle that another leaf has, too");
      }
      is_id_seen_[id] = 1;
      const Bounds& own = primitives_.by_id[id];
      const bool is_held =
          primitives_.has_duplicates ? !intersection_of(left, own).is_empty() : left.contains(own);
      if (!is_held) fail(node, "has a triangle that reaches out of what is left to it");
    }
  }

  const BinaryLayout& layout_;
  const PrimitiveBoxes& primitives_;
  Array<uint8_t> is_block_seen_, is_id_seen_;
  uint32_t visited_ = 0;
  uint32_t size_ = 0;
  Task stack_[kMaxWideDepth + 1];
};

}  // namespace

void verify_binary_layout(const BinaryLayout& layout, const PrimitiveBoxes& primitives,
                          Memory& memory) {
  LayoutVerifier(layout, primitives, memory).run();
}

}  // namespace kiwami
