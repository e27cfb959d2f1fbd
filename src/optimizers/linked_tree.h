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
  LinkedTree(BinaryBvh& bvh, Memory& memory) : bvh_(bvh), memory_(memory), changes_(memory) {
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
    double added = 0.0;
    const BinaryNode moved = bvh_.nodes[node];
    // The pair is free by now, and the target is at neither of its slots.
    const uint32_t pair = take_out(node, added);
    put_beside(moved, pair, target, added);
    return added;
  }

  /// Takes out a node, which is not the root; its sibling moves to the parent's slot. Returns the
  /// first slot of the pair that is free then. Adds what that adds to the area of the inner nodes.
  uint32_t take_out(uint32_t node, double& added) {
    const uint32_t above = parents_[node], pair = bvh_.nodes[above].first;
    added -= bvh_.nodes[above].bounds.half_area();
    place(above, bvh_.nodes[sibling(node)]);
    added += refit_above(above);
    return pair;
  }

  /// Puts a node that is not in the tree beside target: both into a free pair, the target first,
  /// under a new node in the target's slot.
  void put_beside(const BinaryNode& node, uint32_t pair, uint32_t target, double& added) {
    const BinaryNode beside = bvh_.nodes[target];
    Bounds both = beside.bounds;
    both.extend(node.bounds);
    place(pair, beside);
    place(pair + 1, node);
    place(target, {both, pair, 0});
    added += both.half_area();
    added += refit_above(target);
  }

  /// From here on, changes can be undone.
  void begin_changes() {
    is_recording_ = true;
    while (!changes_.empty()) changes_.pop_back();
  }

  /// Brings back the tree of the last begin_changes.
  void undo_changes() {
    for (size_t i = changes_.size(); i-- > 0;) bvh_.nodes[changes_[i].slot] = changes_[i].before;
    for (size_t i = 0; i < changes_.size(); ++i) adopt(changes_[i].slot);
    begin_changes();
  }

  /// Ends the editing: depth first again, no deeper than trees may be.
  void finish() {
    parents_ = Array<uint32_t>();
    relabel_depth_first(bvh_, memory_);
    limit_depth(bvh_, memory_);
  }

 private:
  struct Change {
    uint32_t slot;
    BinaryNode before;
  };

  void record(uint32_t slot) {
    if (is_recording_) changes_.push_back({slot, bvh_.nodes[slot]});
  }

  void place(uint32_t slot, const BinaryNode& node) {
    record(slot);
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
      record(slot);
      node.bounds = bounds;
    }
    return added;
  }

  BinaryBvh& bvh_;
  Memory& memory_;
  Array<uint32_t> parents_;
  GrowingArray<Change> changes_;
  bool is_recording_ = false;
};

}  // namespace kiwami
