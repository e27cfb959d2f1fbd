// SPDX-License-Identifier: Apache-2.0
#include "wide/contraction.h"

#include <algorithm>

namespace kiwami {
namespace {

constexpr uint32_t kMaxWidth = 16;

/// The slots of the node that is being made, in the order of the binary tree's leaves.
class SlotList {
 public:
  SlotList(const BinaryBvh& binary, uint32_t root) : binary_(binary) { insert(0, root); }

  /// Replaces inner children by theirs, largest area first, until width slots are used.
  void open_until(uint32_t width) {
    while (size_ < width) {
      const float* largest = std::max_element(area_, area_ + size_);
      if (*largest < 0.0f) return;
      open(static_cast<uint32_t>(largest - area_));
    }
  }

  uint32_t size() const { return size_; }
  uint32_t operator[](uint32_t slot) const { return node_[slot]; }

 private:
  void open(uint32_t slot) {
    const uint32_t first = binary_.nodes[node_[slot]].first;
    set(slot, first);
    insert(slot + 1, first + 1);
  }

  void insert(uint32_t slot, uint32_t node) {
    std::copy_backward(node_ + slot, node_ + size_, node_ + size_ + 1);
    std::copy_backward(area_ + slot, area_ + size_, area_ + size_ + 1);
    ++size_;
    set(slot, node);
  }

  void set(uint32_t slot, uint32_t node) {
    const BinaryNode& binary_node = binary_.nodes[node];
    node_[slot] = node;
    area_[slot] = binary_node.is_leaf() ? -1.0f : binary_node.bounds.half_area();
  }

  const BinaryBvh& binary_;
  uint32_t size_ = 0;
  uint32_t node_[kMaxWidth];
  float area_[kMaxWidth];  ///< negative: a leaf, which cannot be opened
};

/// The walk that makes all nodes.
class Contractor {
 public:
  Contractor(const BinaryBvh& binary, uint32_t width, Memory& memory)
      : binary_(binary), width_(width), nodes_(memory), slots_(memory), pending_(memory) {}

  Contraction run() {
    add_slot(0, 1);
    while (!pending_.empty()) {
      const Pending pending = pending_.back();
      pending_.pop_back();
      expand(pending);
    }
    result_.nodes = nodes_.take();
    result_.slots = slots_.take();
    return std::move(result_);
  }

 private:
  /// A contracted node that has its index but not yet its slots.
  struct Pending {
    uint32_t node, binary_node, depth;
  };

  void expand(const Pending& pending) {
    result_.depth = std::max(result_.depth, pending.depth);
    SlotList list(binary_, pending.binary_node);
    list.open_until(width_);
    nodes_[pending.node] = {static_cast<uint32_t>(slots_.size()), list.size()};
    const size_t first_pending = pending_.size();
    for (uint32_t slot = 0; slot < list.size(); ++slot) add_slot(list[slot], pending.depth + 1);
    // The stack hands out the last first: the first child's subtree is to come next.
    for (size_t low = first_pending, high = pending_.size(); low + 1 < high; ++low) {
      std::swap(pending_[low], pending_[--high]);
    }
  }

  void add_slot(uint32_t binary_index, uint32_t depth) {
    const BinaryNode& node = binary_.nodes[binary_index];
    const double area = node.bounds.half_area();
    if (node.is_leaf()) {
      result_.leaf_area += area;
      slots_.push_back({binary_index, kLeafFlag | result_.leaf_count++});
      return;
    }
    result_.node_area += area;
    const uint32_t index = static_cast<uint32_t>(nodes_.size());
    nodes_.push_back({0, 0});
    slots_.push_back({binary_index, index});
    pending_.push_back({index, binary_index, depth});
  }

  const BinaryBvh& binary_;
  uint32_t width_;
  GrowingArray<ContractedNode> nodes_;
  GrowingArray<ContractedSlot> slots_;
  GrowingArray<Pending> pending_;
  Contraction result_;
};

}  // namespace

Contraction contract(const BinaryBvh& binary, uint32_t width, Memory& memory) {
  return Contractor(binary, width, memory).run();
}

}  // namespace kiwami
