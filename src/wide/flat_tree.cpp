// SPDX-License-Identifier: Apache-2.0
#include "wide/flat_tree.h"

#include <bit>

#include "core/error.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Walks the stored nodes path by path.
template <int N>
class Flattener {
 public:
  Flattener(const WideTree& tree, Memory& memory) : tree_(tree), memory_(memory), nodes_(memory) {}

  FlatTree run() {
    if (tree_.view.root.mask() != 0) walk();
    FlatTree flat{nodes_.take(), Array<uint32_t>(memory_, tree_.used_lanes)};
    number_primitives(flat.nodes);
    collect_primitives(flat);
    return flat;
  }

 private:
  /// Of a child, with nothing yet below it; a leaf is complete.
  kiwami_bvh_node make_node(ChildReference reference, uint32_t parent, uint32_t depth) {
    kiwami_bvh_node node{};
    node.parent = parent;
    node.depth = depth;
    node.storage_index = static_cast<uint32_t>(tree_.number_of(reference));
    node.storage_mask = reference.mask();
    if (reference.is_leaf()) {
      node.primitive_count = static_cast<uint32_t>(std::popcount(node.storage_mask));
    }
    return node;
  }

  /// From the stored frame, rounded outwards once more.
  void set_box(const WideNode<N>& stored, int slot, kiwami_bvh_node& node) const {
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = tree_.view.centre[axis];
      node.lower[axis] = subtract_down(stored.bounds[axis][0][slot], -centre);
      node.upper[axis] = subtract_up(stored.bounds[axis][1][slot], -centre);
    }
  }

  void set_root_box(kiwami_bvh_node& root) const {
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = tree_.view.centre[axis], limit = tree_.view.greatest_bound[axis];
      root.lower[axis] = subtract_down(-limit, -centre);
      root.upper[axis] = subtract_up(limit, -centre);
    }
  }

  void walk() {
    nodes_.push_back(make_node(tree_.view.root, KIWAMI_INVALID_ID, 0));
    set_root_box(nodes_[0]);
    for (size_t i = 0; i < nodes_.size(); ++i) {
      if (nodes_[i].primitive_count == 0) open(static_cast<uint32_t>(i));
    }
  }

  void open(uint32_t index) {
    const uint32_t mask = nodes_[index].storage_mask;
    const uint32_t depth = nodes_[index].depth + 1;
    const WideNode<N>* stored = tree_.nodes<N>() + nodes_[index].storage_index;
    nodes_[index].first_child = static_cast<uint32_t>(nodes_.size());
    nodes_[index].child_count = static_cast<uint32_t>(std::popcount(mask));
    if (nodes_.size() + N >= KIWAMI_INVALID_ID) {
      throw Error(KIWAMI_ERROR_TOO_LARGE, "the tree has more than %zu nodes, expected at most %u",
                  nodes_.size(), KIWAMI_INVALID_ID - 1);
    }
    for (uint32_t left = mask; left != 0; left &= left - 1) {
      const int slot = std::countr_zero(left);
      set_box(*stored, slot, nodes_.push_back(make_node(stored->child[slot], index, depth)));
    }
  }

  /// Counts from below, as children stand after their parents, then gives out the runs from above.
  static void number_primitives(Array<kiwami_bvh_node>& nodes) {
    for (size_t i = nodes.size(); i-- > 1;) {
      nodes[nodes[i].parent].primitive_count += nodes[i].primitive_count;
    }
    for (const kiwami_bvh_node& node : nodes) {
      uint32_t next = node.first_primitive;
      for (uint32_t i = 0; i < node.child_count; ++i) {
        kiwami_bvh_node& child = nodes[node.first_child + i];
        child.first_primitive = next;
        next += child.primitive_count;
      }
    }
  }

  void collect_primitives(FlatTree& flat) const {
    const LeafBlock<N>* const leaves = tree_.leaves<N>();
    for (const kiwami_bvh_node& node : flat.nodes) {
      if (node.child_count != 0) continue;
      uint32_t* to = flat.primitive_ids.data() + node.first_primitive;
      for (uint32_t left = node.storage_mask; left != 0; left &= left - 1) {
        *to++ = leaves[node.storage_index].id[std::countr_zero(left)];
      }
    }
  }

  const WideTree& tree_;
  Memory& memory_;
  GrowingArray<kiwami_bvh_node> nodes_;
};

}  // namespace

FlatTree flatten(const WideTree& tree, Memory& memory) {
  switch (tree.width) {
    case 4:
      return Flattener<4>(tree, memory).run();
    case 8:
      return Flattener<8>(tree, memory).run();
    default:
      return Flattener<16>(tree, memory).run();
  }
}

}  // namespace kiwami
