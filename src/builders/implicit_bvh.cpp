// SPDX-License-Identifier: Apache-2.0
#include "builders/implicit_bvh.h"

#include <algorithm>

#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 4096;

}  // namespace

ImplicitBvh::ImplicitBvh(const Array<BuildPrimitive>& primitives, Memory& memory,
                         const Parallel& parallel)
    : layout_(std::max(1u, static_cast<uint32_t>(primitives.size()))),
      bounds_(memory, layout_.node_count()),
      primitive_ids_(memory, primitives.size()) {
  Bounds* const leaves = &bounds_[layout_.position(layout_.leaf(0))];
  parallel.for_blocks(primitives.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      leaves[i] = primitives[i].bounds();
      primitive_ids_[i] = primitives[i].id;
    }
  });
  for (uint32_t level = layout_.leaf_level(); level-- > 0;) {
    const uint32_t first = ImplicitLayout::first_of_level(level);
    parallel.for_blocks(layout_.count_of_level(level), kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const uint32_t node = first + static_cast<uint32_t>(i);
        const uint32_t left = ImplicitLayout::left_child(node);
        Bounds both = bounds(left);
        if (!layout_.is_virtual(left + 1)) both.extend(bounds(left + 1));
        bounds_[layout_.position(node)] = both;
      }
    });
  }
}

/// Where the children of a node with two of them stand in a tree of such nodes. The last node of a
/// level has but one child where the level below has an odd number of nodes.
uint32_t ImplicitBvh::first_child_slot(uint32_t node) const {
  uint32_t pair = layout_.position(node);
  for (uint32_t level = ImplicitLayout::level_of(node); level > 0; --level) {
    pair -= layout_.count_of_level(level) % 2;
  }
  return 2 * pair + 1;
}

/// What stands for a node in a tree in which every inner node has two children.
BinaryNode ImplicitBvh::binary_node(uint32_t node) const {
  while (!layout_.is_leaf(node) && layout_.is_virtual(ImplicitLayout::left_child(node) + 1)) {
    node = ImplicitLayout::left_child(node);
  }
  if (layout_.is_leaf(node)) return {bounds(node), layout_.place_of_leaf(node), 1};
  return {bounds(node), first_child_slot(node), 0};
}

BinaryBvh ImplicitBvh::to_binary(Memory& memory, const Parallel& parallel) const {
  if (primitive_ids_.empty()) return {};
  BinaryBvh bvh{Array<BinaryNode>(memory, 2 * primitive_ids_.size() - 1),
                Array<uint32_t>(memory, primitive_ids_.size())};
  std::copy(primitive_ids_.begin(), primitive_ids_.end(), bvh.primitive_ids.begin());
  bvh.nodes[0] = binary_node(0);
  for (uint32_t level = 0; level < layout_.leaf_level(); ++level) {
    const uint32_t first = ImplicitLayout::first_of_level(level);
    parallel.for_blocks(layout_.count_of_level(level), kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const uint32_t node = first + static_cast<uint32_t>(i);
        const uint32_t left = ImplicitLayout::left_child(node);
        if (layout_.is_virtual(left + 1)) continue;
        const uint32_t slot = first_child_slot(node);
        bvh.nodes[slot] = binary_node(left);
        bvh.nodes[slot + 1] = binary_node(left + 1);
      }
    });
  }
  relabel_depth_first(bvh, memory);
  return bvh;
}

}  // namespace kiwami
