// SPDX-License-Identifier: Apache-2.0
#include "wide/contraction.h"

#include <algorithm>

#include "wide/contraction_walk.h"

namespace kiwami {
namespace {

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
  ChosenSlot operator[](uint32_t slot) const { return {node_[slot], area_[slot] < 0.0f}; }

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
  uint32_t node_[kMaxContractionWidth];
  float area_[kMaxContractionWidth];  ///< negative: a leaf, which cannot be opened
};

/// Children by surface area.
struct SurfaceAreaChooser {
  const BinaryBvh& binary;
  uint32_t width;

  uint32_t choose(uint32_t binary_node, ChosenSlot* chosen) const {
    SlotList list(binary, binary_node);
    list.open_until(width);
    for (uint32_t i = 0; i < list.size(); ++i) chosen[i] = list[i];
    return list.size();
  }
};

}  // namespace

Contraction contract(const BinaryBvh& binary, uint32_t width, Memory& memory,
                     const Parallel& parallel) {
  const SurfaceAreaChooser chooser{binary, width};
  ParallelContraction contraction(binary, chooser, memory, parallel);
  return contraction.run({0, binary.nodes[0].is_leaf()});
}

}  // namespace kiwami
