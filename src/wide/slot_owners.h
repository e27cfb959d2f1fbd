// SPDX-License-Identifier: Apache-2.0
// The slots of a wide tree by who owns them, and their order.
#pragma once

#include <algorithm>
#include <bit>
#include <type_traits>

#include "core/memory.h"
#include "math/bounds.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// A reference to a node, whose slots it owns: those of the mask. Several owners may share a node.
struct SlotOwner {
  uint32_t node;
  uint32_t mask;
  uint32_t parent;       ///< the owner in whose slot the reference stands; the root's: itself
  uint32_t parent_slot;  ///< the slot of the parent's node; the root's: 0
  uint32_t first_child;  ///< its slots that lead to nodes are owners from here on, by slot
};

template <int N>
Bounds box_of(const WideNode<N>& node, int slot) {
  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    box.lower[axis] = node.bounds[axis][0][slot];
    box.upper[axis] = node.bounds[axis][1][slot];
  }
  return box;
}

/// All owners of a tree, breadth first: parents before children. None where the root is no node.
template <int N>
Array<SlotOwner> collect_owners(const WideTree& tree, Memory& memory) {
  GrowingArray<SlotOwner> owners(memory);
  const auto add = [&](ChildReference reference, uint32_t parent, uint32_t parent_slot) {
    const auto node = static_cast<uint32_t>(tree.number_of(reference));
    owners.push_back({node, reference.mask(), parent, parent_slot, 0});
  };
  if (tree.view.root.mask() != 0 && !tree.view.root.is_leaf()) add(tree.view.root, 0, 0);
  for (uint32_t i = 0; i < owners.size(); ++i) {
    owners[i].first_child = static_cast<uint32_t>(owners.size());
    const WideNode<N>& node = tree.nodes<N>()[owners[i].node];
    for (uint32_t mask = owners[i].mask; mask != 0; mask &= mask - 1) {
      const auto slot = static_cast<uint32_t>(std::countr_zero(mask));
      if (!node.child[slot].is_leaf()) add(node.child[slot], i, slot);
    }
  }
  return owners.take();
}

/// The slots of one owner, with the value by which they are to be ordered.
template <int N>
class SlotSorter {
 public:
  void add(int slot, double value) { entries_[size_++] = {value, slot}; }

  /// By falling value; equal ones stay as they are.
  void sort() {
    std::stable_sort(entries_, entries_ + size_,
                     [](const Entry& a, const Entry& b) { return a.value > b.value; });
  }

  int size() const { return size_; }
  int operator[](int i) const { return entries_[i].slot; }

  /// Moves the contents of the slots into that order. Other owners' slots are not touched.
  void apply(WideNode<N>& node, uint32_t mask) const {
    Slot contents[N];
    for (int i = 0; i < size_; ++i) contents[i] = read(node, entries_[i].slot);
    for (int i = 0; i < size_; ++i, mask &= mask - 1) {
      write(contents[i], node, std::countr_zero(mask));
    }
  }

 private:
  struct Entry {
    double value;
    int slot;
  };
  struct Slot {
    Bounds box;
    ChildReference child;
  };

  static Slot read(const WideNode<N>& node, int slot) {
    return {box_of(node, slot), node.child[slot]};
  }

  static void write(const Slot& from, WideNode<N>& node, int slot) {
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[axis][0][slot] = from.box.lower[axis];
      node.bounds[axis][1][slot] = from.box.upper[axis];
    }
    node.child[slot] = from.child;
  }

  Entry entries_[N];
  int size_ = 0;
};

/// Calls run(std::integral_constant<int, N>()) for a width that is known at run time only.
template <typename Run>
void with_width(uint32_t width, Run&& run) {
  if (width == 4) return run(std::integral_constant<int, 4>());
  if (width == 8) return run(std::integral_constant<int, 8>());
  run(std::integral_constant<int, 16>());
}

}  // namespace kiwami
