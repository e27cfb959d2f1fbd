// SPDX-License-Identifier: Apache-2.0
#include "bvh/flat_edit.h"

#include <algorithm>

#include "core/error.h"

namespace kiwami {
namespace {

/// Nodes that one task gives their boxes.
constexpr size_t kBlockSize = 2048;

Bounds box_of(const kiwami_bvh_node& node) {
  return {{node.lower[0], node.lower[1], node.lower[2]},
          {node.upper[0], node.upper[1], node.upper[2]}};
}

void set_box(kiwami_bvh_node& node, const Bounds& box) {
  for (int axis = 0; axis < 3; ++axis) {
    node.lower[axis] = box.lower[axis];
    node.upper[axis] = box.upper[axis];
  }
}

bool overlap(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(a.lower[axis] <= b.upper[axis] && b.lower[axis] <= a.upper[axis])) return false;
  }
  return true;
}

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_VALIDATION, format, values...);
}

/// One pass over the nodes in their order.
class FlatVerifier {
 public:
  FlatVerifier(std::span<const kiwami_bvh_node> nodes, const Array<uint32_t>& primitive_ids,
               const Array<Bounds>& boxes, uint32_t width, uint32_t leaf_width, Memory& memory)
      : nodes_(nodes),
        primitive_ids_(primitive_ids),
        boxes_(boxes),
        width_(width),
        leaf_width_(leaf_width),
        found_(memory, boxes.size()) {
    found_.fill_zero();
  }

  void run() {
    if (!nodes_.empty()) check_root();
    count_primitives();
    uint32_t next_child = 1;
    for (uint32_t i = 0; i < nodes_.size(); ++i) {
      // What is nobody's child has a run of primitives that nobody has checked.
      if (i == next_child) fail("node %u is the child of none", i);
      if (nodes_[i].child_count == 0) {
        check_leaf(i);
      } else {
        check_children(i, next_child);
      }
    }
    if (!nodes_.empty() && next_child != nodes_.size()) {
      fail("the nodes have %u children, expected %zu", next_child - 1, nodes_.size() - 1);
    }
    for (size_t id = 0; id < boxes_.size(); ++id) {
      if (found_[id] == 0 && !boxes_[id].is_empty()) fail("primitive %zu is in no leaf", id);
    }
  }

 private:
  void check_root() const {
    const kiwami_bvh_node& root = nodes_[0];
    if (root.parent != KIWAMI_INVALID_ID || root.depth != 0) {
      fail("the root has parent %u and depth %u, expected none and 0", root.parent, root.depth);
    }
    if (root.first_primitive != 0 || root.primitive_count != primitive_ids_.size()) {
      fail("the root has primitives %u to %u, expected all %zu", root.first_primitive,
           root.first_primitive + root.primitive_count, primitive_ids_.size());
    }
  }

  void count_primitives() {
    for (const uint32_t id : primitive_ids_) {
      if (id >= boxes_.size()) {
        fail("primitive id %u is none, expected less than %zu", id, boxes_.size());
      }
      if (boxes_[id].is_empty()) fail("primitive %u has no box, expected it in no leaf", id);
      if (found_[id] < 2) ++found_[id];
    }
  }

  void check_leaf(uint32_t index) const {
    const kiwami_bvh_node& leaf = nodes_[index];
    if (leaf.primitive_count == 0 || leaf.primitive_count > leaf_width_) {
      fail("leaf %u has %u primitives, expected 1 to %u", index, leaf.primitive_count, leaf_width_);
    }
    for (uint32_t i = 0; i < leaf.primitive_count; ++i) {
      const uint32_t id = primitive_ids_[leaf.first_primitive + i];
      const Bounds box = box_of(leaf);
      const bool is_split = found_[id] > 1;
      if (is_split ? !overlap(box, boxes_[id]) : !box.contains(boxes_[id])) {
        fail("the box of leaf %u does not contain primitive %u", index, id);
      }
    }
  }

  void check_children(uint32_t index, uint32_t& next_child) const {
    const kiwami_bvh_node& node = nodes_[index];
    if (node.first_child != next_child || node.child_count > width_ ||
        node.child_count > nodes_.size() - next_child) {
      fail("node %u has %u children from %u on, expected at most %u from %u on", index,
           node.child_count, node.first_child, width_, next_child);
    }
    uint32_t next_primitive = node.first_primitive;
    for (uint32_t i = 0; i < node.child_count; ++i) {
      const uint32_t number = next_child + i;
      const kiwami_bvh_node& child = nodes_[number];
      if (child.parent != index || child.depth != node.depth + 1) {
        fail("node %u has parent %u and depth %u, expected %u and %u", number, child.parent,
             child.depth, index, node.depth + 1);
      }
      if (child.first_primitive != next_primitive || child.primitive_count > node.primitive_count) {
        fail("node %u has %u primitives from %u on, expected them from %u on", number,
             child.primitive_count, child.first_primitive, next_primitive);
      }
      next_primitive += child.primitive_count;
      if (!box_of(node).contains(box_of(child))) {
        fail("the box of node %u leaves that of its parent, node %u", number, index);
      }
    }
    if (next_primitive - node.first_primitive != node.primitive_count) {
      fail("node %u has %u primitives, expected the %u of its children", index,
           node.primitive_count, next_primitive - node.first_primitive);
    }
    next_child += node.child_count;
  }

  std::span<const kiwami_bvh_node> nodes_;
  const Array<uint32_t>& primitive_ids_;
  const Array<Bounds>& boxes_;
  uint32_t width_, leaf_width_;
  Array<uint8_t> found_;  ///< by id: in how many leaves; 2 for more
};

}  // namespace

void refit(Array<kiwami_bvh_node>& nodes, const Array<uint32_t>& primitive_ids,
           const Array<Bounds>& boxes, const Parallel& parallel) {
  size_t end = nodes.size();
  while (end != 0) {
    // Breadth first, a level is a run.
    const uint32_t depth = nodes[end - 1].depth;
    const kiwami_bvh_node* const first =
        std::lower_bound(nodes.begin(), nodes.begin() + end, depth,
                         [](const kiwami_bvh_node& node, uint32_t of) { return node.depth < of; });
    const size_t begin = static_cast<size_t>(first - nodes.begin());
    parallel.for_blocks(end - begin, kBlockSize, [&](size_t from, size_t to) {
      for (size_t i = begin + from; i < begin + to; ++i) {
        kiwami_bvh_node& node = nodes[i];
        Bounds box = Bounds::empty();
        for (uint32_t c = 0; c < node.child_count; ++c) {
          box.extend(box_of(nodes[node.first_child + c]));
        }
        if (node.child_count == 0) {
          for (uint32_t p = 0; p < node.primitive_count; ++p) {
            box.extend(boxes[primitive_ids[node.first_primitive + p]]);
          }
        }
        set_box(node, box);
      }
    });
    end = begin;
  }
}

void verify_flat_tree(std::span<const kiwami_bvh_node> nodes, const Array<uint32_t>& primitive_ids,
                      const Array<Bounds>& boxes, uint32_t width, uint32_t leaf_width,
                      Memory& memory) {
  FlatVerifier(nodes, primitive_ids, boxes, width, leaf_width, memory).run();
}

}  // namespace kiwami
