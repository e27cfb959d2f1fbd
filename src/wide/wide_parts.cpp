// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_parts.h"

#include <algorithm>

namespace kiwami {

WideParts::~WideParts() {
  for (size_t i = 0; i < parts_.size(); ++i) {
    memory_.deallocate(parts_[i].nodes, parts_[i].bytes(), WidePart::kAlignment);
  }
}

uint32_t WideParts::start_level(size_t part_count) {
  level_parts_[level_] = static_cast<uint32_t>(parts_.size());
  for (size_t i = 0; i < part_count; ++i) parts_.push_back(WidePart{});
  return level_parts_[level_];
}

/// The last level first, since it stands at the root.
WideDraft WideParts::join(Array<uint32_t> primitive_ids) {
  Array<Offsets> offsets(memory_, parts_.size());
  WideDraft draft;
  Offsets end = {0, 1, 0};
  for (uint32_t level = level_; level-- > 0;) {
    for (size_t i = level_parts_[level]; i < end_of_level(level); ++i) {
      offsets[i] = end;
      end = {end.node + parts_[i].node_count, end.slot + parts_[i].slot_count,
             end.leaf + parts_[i].leaf_count};
      draft.node_area += parts_[i].node_area;
      draft.leaf_area += parts_[i].leaf_area;
    }
  }
  draft.nodes = Array<ContractedNode>(memory_, end.node);
  draft.children = Array<uint32_t>(memory_, end.slot);
  draft.boxes = Array<Bounds>(memory_, end.slot);
  draft.leaf_sizes = Array<uint8_t>(memory_, end.leaf);
  const WideCluster& root = clusters()[0];
  draft.depth = root.height;
  draft.boxes[0] = root.box;
  draft.children[0] = place_of(root, offsets);
  for (uint32_t level = 0; level < level_; ++level) {
    const size_t first = level_parts_[level];
    parallel_.for_each(end_of_level(level) - first,
                       [&](size_t i) { copy(first + i, level, offsets, draft); });
  }
  draft.primitive_ids = std::move(primitive_ids);
  return draft;
}

void WideParts::copy(size_t number, uint32_t level, const Array<Offsets>& offsets,
                     WideDraft& draft) const {
  const WidePart& part = parts_[number];
  const Offsets& offset = offsets[number];
  for (uint32_t i = 0; i < part.node_count; ++i) {
    draft.nodes[offset.node + i] = {part.nodes[i].first_slot + offset.slot,
                                    part.nodes[i].slot_count};
  }
  for (uint32_t i = 0; i < part.slot_count; ++i) {
    const uint32_t child = part.children[i];
    uint32_t& to = draft.children[offset.slot + i];
    if (child & kLeafFlag) {
      to = child + offset.leaf;
    } else if (child & kClusterFlag) {
      to = place_of(clusters_[level - 1][child & ~kClusterFlag], offsets);
    } else {
      to = child + offset.node;
    }
  }
  std::copy_n(part.boxes, part.slot_count, draft.boxes.begin() + offset.slot);
  std::copy_n(part.leaf_sizes, part.leaf_count, draft.leaf_sizes.begin() + offset.leaf);
}

}  // namespace kiwami
