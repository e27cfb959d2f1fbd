// SPDX-License-Identifier: Apache-2.0
// A binary tree with links to the parents, as optimisers edit it.
#pragma once

#include "bvh/tree_edit.h"

namespace kiwami {

/// Numbers are slots: siblings stand at first and first + 1 of their parent, at an odd and the next
/// even slot. A move writes other nodes to slots.
class LinkedTree {
 public:
  /// Numbers the tree depth first.
  LinkedTree(BinaryBvh& bvh, Memory& memory) : bvh_(bvh), memory_(memory) {
    relabel_depth_first(bvh, memory);
    parents_ = Array<uint32_t>(memory, bvh.nodes.size());
    if (!bvh.nodes.empty()) parents_[0] = 0;
    for (uint32_t i = 0; i < size(); ++i) adopt(i);
  }

  uint32_t size() const { return static_cast<uint32_t>(bvh_.nodes.size()); }
  const BinaryNode& operator[](uint32_t slot) const { return bvh_.nodes[slot]; }
  /// Not of the root.
  uint32_t parent(uint32_t slot) const { return parents_[slot]; }
  uint32_t sibling(uint32_t slot) const { return slot % 2 != 0 ? slot + 1 : slot - 1; }

  bool is_below(uint32_t slot, uint32_t ancestor) const {
    while (slot > 0 && slot != ancestor) slot = parents_[slot];
    return slot == ancestor;
  }

  /// Takes a node out of the tree and puts it beside target. The node must not be the root, nor the
  /// target below it, its parent or its sibling. Its sibling moves to the parent's slot, the target
  /// to the first and the node to the second slot of the pair. Returns what that adds to the area
  /// of the inner nodes.
  double move(uint32_t node, uint32_t target) {
    const uint32_t above = parents_[node], pair = bvh_.nodes[above].first;
    const BinaryNode moved = bvh_.nodes[node];
    double added = -static_cast<double>(bvh_.nodes[above].bounds.half_area());
    place(above, bvh_.nodes[sibling(node)]);
    added += refit_above(above);
    // The sibling's slots are free by now, and the target is at neither of them.
    const BinaryNode beside = bvh_.nodes[target];
    parents_[pair] = parents_[pair + 1] = target;
    place(pair, beside);
    place(pair + 1, moved);
    Bounds both = beside.bounds;
    both.extend(moved.bounds);
    bvh_.nodes[target] = {both, pair, 0};
    added += both.half_area();
    return added + refit_above(target);
  }

  /// Ends the editing: depth first again, no deeper than trees may be.
  void finish() {
    parents_ = Array<uint32_t>();
    relabel_depth_first(bvh_, memory_);
    limit_depth(bvh_, memory_);
  }

 private:
  void place(uint32_t slot, const BinaryNode& node) {
    bvh_.nodes[slot] = node;
    adopt(slot);
  }

  void adopt(uint32_t slot) {
    const BinaryNode& node = bvh_.nodes[slot];
    if (!node.is_leaf()) parents_[node.first] = parents_[node.first + 1] = slot;
  }

  /// Fits the boxes above a slot, up to the first that stays; returns what that adds to their area.
  double refit_above(uint32_t slot) {
    double added = 0.0;
    while (slot != 0) {
      slot = parents_[slot];
      BinaryNode& node = bvh_.nodes[slot];
      Bounds bounds = bvh_.nodes[node.first].bounds;
      bounds.extend(bvh_.nodes[node.first + 1].bounds);
      if (node.bounds.contains(bounds) && bounds.contains(node.bounds)) break;
      added += static_cast<double>(bounds.half_area()) - node.bounds.half_area();
      node.bounds = bounds;
    }
    return added;
  }

  BinaryBvh& bvh_;
  Memory& memory_;
  Array<uint32_t> parents_;
};

}  // namespace kiwami
