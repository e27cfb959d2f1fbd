// SPDX-License-Identifier: Apache-2.0
// A binary tree without pointers: where a node stands follows from its number alone.
#pragma once

#include <bit>

#include "bvh/binary_bvh.h"
#include "parallel/parallel.h"

namespace kiwami {

/// The arithmetic of an ostensibly implicit tree: F. M. Chitalu, C. Dubach, T. Komura, "Binary
/// Ostensibly-Implicit Trees for Fast Collision Detection", CGF 39(2) (Eurographics), 2020. The
/// complete binary tree over the next power of two leaves is numbered in the order of its levels
/// (the root is 0, the children of i are 2 i + 1 and 2 i + 2). Its nodes over no leaf are virtual:
/// they are the last ones of each level, and no memory is kept for them.
class ImplicitLayout {
 public:
  /// leaf_count is at least 1 and at most 2^31.
  explicit ImplicitLayout(uint32_t leaf_count)
      : leaf_level_(static_cast<uint32_t>(std::bit_width(leaf_count - 1))),
        virtual_leaves_((1u << leaf_level_) - leaf_count) {}

  uint32_t leaf_level() const { return leaf_level_; }
  /// Nodes for which there is memory.
  uint32_t node_count() const {
    return 2 * (1u << leaf_level_) - 1 - virtual_above(leaf_level_ + 1);
  }

  static uint32_t parent(uint32_t node) { return (node - 1) / 2; }
  static uint32_t left_child(uint32_t node) { return 2 * node + 1; }
  static bool is_left_child(uint32_t node) { return node % 2 != 0; }
  static uint32_t level_of(uint32_t node) {
    return static_cast<uint32_t>(std::bit_width(node + 1)) - 1;
  }
  static uint32_t first_of_level(uint32_t level) { return (1u << level) - 1; }

  /// The nodes of a level that are not virtual: the first ones.
  uint32_t count_of_level(uint32_t level) const {
    return (1u << level) - (virtual_leaves_ >> (leaf_level_ - level));
  }
  bool is_virtual(uint32_t node) const {
    const uint32_t level = level_of(node);
    return node - first_of_level(level) >= count_of_level(level);
  }
  bool is_leaf(uint32_t node) const { return level_of(node) == leaf_level_; }
  /// Of a leaf, by its place from the left.
  uint32_t leaf(uint32_t place) const { return first_of_level(leaf_level_) + place; }
  uint32_t place_of_leaf(uint32_t node) const { return node - first_of_level(leaf_level_); }

  /// Where a node that is not virtual stands in memory.
  uint32_t position(uint32_t node) const { return node - virtual_above(level_of(node)); }

 private:
  /// The virtual nodes of all levels above one: the sum of v >> 1, v >> 2 and so on, v those of the
  /// level itself, as far as the root.
  uint32_t virtual_above(uint32_t level) const {
    const uint32_t last =
        level > leaf_level_ ? 2 * virtual_leaves_ : virtual_leaves_ >> (leaf_level_ - level);
    return last - static_cast<uint32_t>(std::popcount(last));
  }

  uint32_t leaf_level_;
  uint32_t virtual_leaves_;
};

/// Boxes in an implicit layout: 24 bytes a node, and the primitives in the order of the leaves.
class ImplicitBvh {
 public:
  /// Over primitives in an order in which neighbours are near each other, one a leaf.
  ImplicitBvh(const Array<BuildPrimitive>& primitives, Memory& memory, const Parallel& parallel);

  const ImplicitLayout& layout() const { return layout_; }
  const Array<uint32_t>& primitive_ids() const { return primitive_ids_; }
  const Bounds& bounds(uint32_t node) const { return bounds_[layout_.position(node)]; }
  size_t bytes() const { return bounds_.bytes() + primitive_ids_.bytes(); }

  /// Calls visit(primitive id) for each leaf that enters(bounds) lets in, as it does all nodes
  /// above, from left to right. No stack: where to go next follows from the number of the node.
  template <typename Enters, typename Visit>
  void traverse(Enters&& enters, Visit&& visit) const {
    if (primitive_ids_.empty()) return;
    uint32_t node = 0;
    for (;;) {
      if (!layout_.is_virtual(node) && enters(bounds(node))) {
        if (!layout_.is_leaf(node)) {
          node = ImplicitLayout::left_child(node);
          continue;
        }
        visit(primitive_ids_[layout_.place_of_leaf(node)]);
      }
      while (node != 0 && !ImplicitLayout::is_left_child(node)) node = ImplicitLayout::parent(node);
      if (node == 0) return;
      ++node;
    }
  }

  /// The same tree with pointers, numbered depth first.
  BinaryBvh to_binary(Memory& memory, const Parallel& parallel) const;

 private:
  uint32_t first_child_slot(uint32_t node) const;
  BinaryNode binary_node(uint32_t node) const;

  ImplicitLayout layout_;
  Array<Bounds> bounds_;
  Array<uint32_t> primitive_ids_;
};

}  // namespace kiwami
