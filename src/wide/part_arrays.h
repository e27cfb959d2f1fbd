// SPDX-License-Identifier: Apache-2.0
// Where one thread writes the wide nodes of a part.
#pragma once

#include <algorithm>

#include "wide/wide_parts.h"

namespace kiwami {

/// The arrays of a WidePart with room for what is still to come, used for one part after another.
class PartArrays {
 public:
  /// For parts of at most so many nodes, slots and leaves.
  PartArrays(uint32_t nodes, uint32_t slots, uint32_t leaves, Memory& memory)
      : nodes_(memory, nodes),
        children_(memory, slots),
        boxes_(memory, slots),
        leaf_sizes_(memory, leaves) {}

  /// Starts a part, whose primitives are written to ids, leaf by leaf.
  void start(uint32_t* ids) {
    ids_ = ids;
    node_count_ = slot_count_ = leaf_count_ = 0;
    node_area_ = leaf_area_ = 0.0;
  }

  /// The number of a new node.
  uint32_t add_node() { return node_count_++; }
  /// Half the surface area of its box, as soon as that is known.
  void add_node_area(float half_area) { node_area_ += half_area; }
  /// Gives a node slots; returns the first one.
  uint32_t add_slots(uint32_t node, uint32_t count) {
    nodes_[node] = {slot_count_, count};
    slot_count_ += count;
    return nodes_[node].first_slot;
  }
  void set_slot(uint32_t slot, const Bounds& box, uint32_t child) {
    boxes_[slot] = box;
    children_[slot] = child;
  }
  void set_box(uint32_t slot, const Bounds& box) { boxes_[slot] = box; }
  uint32_t child(uint32_t slot) const { return children_[slot]; }
  const Bounds& box(uint32_t slot) const { return boxes_[slot]; }

  /// Where the next leaf's ids go.
  uint32_t* ids() { return ids_; }
  /// A leaf whose ids end before end; returns the reference to it.
  uint32_t add_leaf(uint32_t* end, float half_area) {
    leaf_area_ += half_area;
    leaf_sizes_[leaf_count_] = static_cast<uint8_t>(end - ids_);
    ids_ = end;
    return kLeafFlag | leaf_count_++;
  }

  WidePart take(Memory& memory) const {
    WidePart part{};
    part.node_count = node_count_;
    part.slot_count = slot_count_;
    part.leaf_count = leaf_count_;
    part.node_area = node_area_;
    part.leaf_area = leaf_area_;
    unsigned char* next =
        static_cast<unsigned char*>(memory.allocate(part.bytes(), WidePart::kAlignment));
    part.nodes = copy(nodes_, node_count_, next);
    part.boxes = copy(boxes_, slot_count_, next);
    part.children = copy(children_, slot_count_, next);
    part.leaf_sizes = copy(leaf_sizes_, leaf_count_, next);
    return part;
  }

 private:
  /// Copies to the memory at next, which moves behind the copy.
  template <typename T>
  static T* copy(const Array<T>& from, uint32_t count, unsigned char*& next) {
    T* to = reinterpret_cast<T*>(next);
    std::copy_n(from.begin(), count, to);
    next += count * sizeof(T);
    return to;
  }

  Array<ContractedNode> nodes_;
  Array<uint32_t> children_;
  Array<Bounds> boxes_;
  Array<uint8_t> leaf_sizes_;
  uint32_t* ids_ = nullptr;
  uint32_t node_count_ = 0, slot_count_ = 0, leaf_count_ = 0;
  double node_area_ = 0.0, leaf_area_ = 0.0;
};

}  // namespace kiwami
