// SPDX-License-Identifier: Apache-2.0
#include "optimizers/sato_reorder.h"

#include "wide/slot_owners.h"

namespace kiwami {
namespace {

/// Owners that one task orders.
constexpr size_t kOwnerBlock = 1024;

template <int N>
void reorder(WideTree& tree, Memory& memory, const Parallel& parallel) {
  auto* const nodes = tree.nodes<N>();
  const Array<SlotOwner> owners = collect_owners<N>(tree, memory);
  parallel.for_blocks(owners.size(), kOwnerBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      WideNode<N>& node = nodes[owners[i].node];
      SlotSorter<N> sorter;
      for (uint32_t mask = owners[i].mask; mask != 0; mask &= mask - 1) {
        const int slot = std::countr_zero(mask);
        sorter.add(slot, box_of(node, slot).half_area());
      }
      sorter.sort();
      sorter.apply(node, owners[i].mask);
    }
  });
}

}  // namespace

void reorder_by_surface_area(WideTree& tree, Memory& memory, const Parallel& parallel) {
  with_width(tree.width, [&](auto width) { reorder<width>(tree, memory, parallel); });
}

}  // namespace kiwami
