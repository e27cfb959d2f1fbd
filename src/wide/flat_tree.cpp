// SPDX-License-Identifier: Apache-2.0
#include "wide/flat_tree.h"

#include <algorithm>
#include <bit>

#include "core/error.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Counts from below, as children stand after their parents, then gives out the runs from above.
void number_primitives(Array<kiwami_bvh_node>& nodes) {
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

/// Throws unless so many nodes have numbers of 32 bits.
void check_node_count(size_t count) {
  if (count < KIWAMI_INVALID_ID) return;
  throw Error(KIWAMI_ERROR_TOO_LARGE, "the tree has more than %zu nodes, expected at most %u",
              count - 1, KIWAMI_INVALID_ID - 1);
}

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
    check_node_count(nodes_.size() + N);
    for (uint32_t left = mask; left != 0; left &= left - 1) {
      const int slot = std::countr_zero(left);
      set_box(*stored, slot, nodes_.push_back(make_node(stored->child[slot], index, depth)));
    }
  }

  void collect_primitives(FlatTree& flat) const {
    for (const kiwami_bvh_node& node : flat.nodes) {
      if (node.child_count != 0) continue;
      const uint32_t* const ids = tree_.leaf_ids(node.storage_index);
      uint32_t* to = flat.primitive_ids.data() + node.first_primitive;
      for (uint32_t left = node.storage_mask; left != 0; left &= left - 1) {
        *to++ = ids[std::countr_zero(left)];
      }
    }
  }

  const WideTree& tree_;
  Memory& memory_;
  GrowingArray<kiwami_bvh_node> nodes_;
};

/// A binary tree by the numbers of its nodes.
struct BinaryView {
  const BinaryBvh& binary;

  const Bounds& box_of(uint32_t node) const { return binary.nodes[node].bounds; }
  bool is_leaf(uint32_t node) const { return binary.nodes[node].is_leaf(); }
  uint32_t child_count(uint32_t) const { return 2; }
  uint32_t child(uint32_t node, uint32_t i) const { return binary.nodes[node].first + i; }
  uint32_t primitive_count(uint32_t leaf) const { return binary.nodes[leaf].count; }
  void copy_primitives(uint32_t leaf, uint32_t* to) const {
    std::copy_n(binary.primitive_ids.begin() + binary.nodes[leaf].first, binary.nodes[leaf].count,
                to);
  }
};

/// A contraction by the numbers of its slots.
struct ContractionView {
  const Contraction& contraction;
  const BinaryBvh& binary;

  const ContractedNode& node_of(uint32_t slot) const {
    return contraction.nodes[contraction.slots[slot].child];
  }
  const Bounds& box_of(uint32_t slot) const {
    return binary.nodes[contraction.slots[slot].binary_node].bounds;
  }
  bool is_leaf(uint32_t slot) const { return contraction.slots[slot].is_leaf(); }
  uint32_t child_count(uint32_t slot) const { return node_of(slot).slot_count; }
  uint32_t child(uint32_t slot, uint32_t i) const { return node_of(slot).first_slot + i; }
  uint32_t primitive_count(uint32_t slot) const {
    return contraction.leaf_sizes[contraction.slots[slot].child & ~kLeafFlag];
  }
  void copy_primitives(uint32_t slot, uint32_t* to) const {
    copy_ids_below(binary, contraction.slots[slot].binary_node, to);
  }
};

/// A draft by the numbers of its slots.
class DraftView {
 public:
  DraftView(const WideDraft& draft, Memory& memory)
      : draft_(draft), first_primitive_(memory, draft.leaf_sizes.size()) {
    uint32_t next = 0;
    for (size_t leaf = 0; leaf < draft.leaf_sizes.size(); ++leaf) {
      first_primitive_[leaf] = next;
      next += draft.leaf_sizes[leaf];
    }
  }

  const Bounds& box_of(uint32_t slot) const { return draft_.boxes[slot]; }
  bool is_leaf(uint32_t slot) const { return (draft_.children[slot] & kLeafFlag) != 0; }
  uint32_t child_count(uint32_t slot) const { return node_of(slot).slot_count; }
  uint32_t child(uint32_t slot, uint32_t i) const { return node_of(slot).first_slot + i; }
  uint32_t primitive_count(uint32_t slot) const { return draft_.leaf_sizes[leaf_of(slot)]; }
  void copy_primitives(uint32_t slot, uint32_t* to) const {
    std::copy_n(draft_.primitive_ids.begin() + first_primitive_[leaf_of(slot)],
                primitive_count(slot), to);
  }

 private:
  const ContractedNode& node_of(uint32_t slot) const { return draft_.nodes[draft_.children[slot]]; }
  uint32_t leaf_of(uint32_t slot) const { return draft_.children[slot] & ~kLeafFlag; }

  const WideDraft& draft_;
  Array<uint32_t> first_primitive_;
};

/// The nodes of a tree whose nodes have one parent each; root names the first of them.
template <typename Tree>
FlatTree flatten_unshared(const Tree& tree, uint32_t root, Memory& memory) {
  GrowingArray<kiwami_bvh_node> nodes(memory);
  GrowingArray<uint32_t> names(memory);  // in the tree, by node
  uint32_t inner_count = 0, leaf_count = 0;
  const auto add = [&](uint32_t name, uint32_t parent, uint32_t depth) {
    const Bounds& box = tree.box_of(name);
    kiwami_bvh_node node{};
    for (int axis = 0; axis < 3; ++axis) {
      node.lower[axis] = box.lower[axis];
      node.upper[axis] = box.upper[axis];
    }
    node.parent = parent;
    node.depth = depth;
    nodes.push_back(node);
    names.push_back(name);
    check_node_count(nodes.size());
  };
  add(root, KIWAMI_INVALID_ID, 0);
  for (uint32_t i = 0; i < nodes.size(); ++i) {
    const uint32_t name = names[i], depth = nodes[i].depth;
    if (tree.is_leaf(name)) {
      nodes[i].primitive_count = tree.primitive_count(name);
      nodes[i].storage_index = leaf_count++;
      nodes[i].storage_mask = (1u << nodes[i].primitive_count) - 1;
      continue;
    }
    nodes[i].first_child = static_cast<uint32_t>(nodes.size());
    nodes[i].child_count = tree.child_count(name);
    nodes[i].storage_index = inner_count++;
    nodes[i].storage_mask = (1u << nodes[i].child_count) - 1;
    for (uint32_t c = 0; c < tree.child_count(name); ++c) add(tree.child(name, c), i, depth + 1);
  }
  FlatTree flat{nodes.take(), {}};
  number_primitives(flat.nodes);
  flat.primitive_ids = Array<uint32_t>(memory, flat.nodes[0].primitive_count);
  for (size_t i = 0; i < flat.nodes.size(); ++i) {
    if (flat.nodes[i].child_count != 0) continue;
    tree.copy_primitives(names[i], flat.primitive_ids.data() + flat.nodes[i].first_primitive);
  }
  return flat;
}

}  // namespace

FlatTree flatten(const BinaryBvh& binary, Memory& memory) {
  if (binary.nodes.empty()) return {};
  return flatten_unshared(BinaryView{binary}, 0, memory);
}

FlatTree flatten(const Contraction& contraction, const BinaryBvh& binary, Memory& memory) {
  return flatten_unshared(ContractionView{contraction, binary}, 0, memory);
}

FlatTree flatten(const WideDraft& draft, Memory& memory) {
  if (draft.primitive_ids.empty()) return {};
  return flatten_unshared(DraftView(draft, memory), 0, memory);
}

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
