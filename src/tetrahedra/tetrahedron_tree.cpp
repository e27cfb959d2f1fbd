// SPDX-License-Identifier: Apache-2.0
#include "tetrahedra/tetrahedron_tree.h"

#include "builders/binned_sah_builder.h"
#include "wide/contraction.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 8192;
constexpr uint32_t kWidth = 4;

Array<BuildPrimitive> boxes_of(const TetrahedronSource& source, Memory& memory) {
  Array<BuildPrimitive> boxes(memory, source.tetrahedra.size() - source.skipped_count);
  size_t count = 0;
  for (uint32_t id = 0; id < source.tetrahedra.size(); ++id) {
    if (source.has_volume[id] == 0) continue;
    const Bounds bounds = source.bounds_of(id);
    boxes[count++] = {bounds.lower, id, bounds.upper, 0};
  }
  return boxes;
}

}  // namespace

TetrahedronTree::TetrahedronTree(const TetrahedronSource& source, Memory& memory,
                                 const Parallel& parallel) {
  if (source.tetrahedra.size() == source.skipped_count) return;
  BinnedSahBuilder::Config config;
  config.max_leaf_size = 1;
  config.block_size = 1;
  const BinaryBvh binary =
      BinnedSahBuilder::build(boxes_of(source, memory), config, memory, parallel);
  const Contraction contraction = contract(binary, kWidth, memory, parallel);
  const auto reference_to = [&](const ContractedSlot& slot) {
    if (!slot.is_leaf()) return slot.child;
    return kLeafBit | binary.primitive_ids[binary.nodes[slot.binary_node].first];
  };
  // A root that is a leaf gets a node all the same.
  const bool is_leaf = contraction.nodes.empty();
  nodes_ = Array<Node>(memory, is_leaf ? 1 : contraction.nodes.size());
  parallel.for_blocks(nodes_.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const ContractedNode shape = is_leaf ? ContractedNode{0, 1} : contraction.nodes[i];
      Node& node = nodes_[i];
      for (uint32_t k = 0; k < kWidth; ++k) {
        const bool is_used = k < shape.slot_count;
        const ContractedSlot slot = contraction.slots[shape.first_slot + (is_used ? k : 0)];
        const Bounds bounds = is_used ? binary.nodes[slot.binary_node].bounds : Bounds::empty();
        for (int axis = 0; axis < 3; ++axis) {
          node.lower[axis][k] = bounds.lower[axis];
          node.upper[axis][k] = bounds.upper[axis];
        }
        node.child[k] = is_used ? reference_to(slot) : kLeafBit;
      }
    }
  });
}

}  // namespace kiwami
