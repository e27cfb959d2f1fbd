// SPDX-License-Identifier: Apache-2.0
// What the direct builders of wide trees write, each part by one thread, until all are joined.
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_draft.h"

namespace kiwami {

/// A subtree that has been written: what a part ends with, and those of the next level begin with.
struct WideCluster {
  Bounds box;
  float cost;       ///< as one child
  uint32_t child;   ///< as in WideDraft, with numbers that count from 0 in its part
  uint32_t part;    ///< that it stands in
  uint32_t height;  ///< nodes on the longest path down; 0: a leaf
};

/// The wide nodes of one part, whose numbers count from 0. Parents stand before their children.
/// Whoever keeps it frees bytes() of memory at nodes.
struct WidePart {
  ContractedNode* nodes;
  Bounds* boxes;       ///< by slot
  uint32_t* children;  ///< by slot, as in WideDraft, or kClusterFlag and a cluster's number
  uint8_t* leaf_sizes;
  uint32_t node_count, slot_count, leaf_count;
  double node_area, leaf_area;

  static constexpr size_t kAlignment = 64;

  size_t bytes() const {
    return node_count * sizeof(ContractedNode) + slot_count * (sizeof(Bounds) + sizeof(uint32_t)) +
           leaf_count;
  }
};

/// In the children of a part: a cluster of the level below, by its number.
constexpr uint32_t kClusterFlag = 0x40000000u;

/// The parts of all levels, from the leaves up. Only parts of the first level own primitives, in
/// their order.
class WideParts {
 public:
  /// Each level leaves fewer clusters than a sixteenth, so these are enough for 2^32 primitives.
  static constexpr uint32_t kMostLevels = 8;

  WideParts(Memory& memory, const Parallel& parallel)
      : memory_(memory), parallel_(parallel), parts_(memory) {}
  ~WideParts();
  WideParts(const WideParts&) = delete;
  WideParts& operator=(const WideParts&) = delete;

  /// Starts a level of so many parts; returns the number of the first one.
  uint32_t start_level(size_t part_count);
  /// Takes a part. Several threads may set different ones.
  void set(uint32_t number, const WidePart& part) { parts_[number] = part; }
  /// Ends the level, with the clusters that the next one begins with.
  void end_level(Array<WideCluster> clusters) { clusters_[level_++] = std::move(clusters); }

  /// Levels that are complete.
  uint32_t level_count() const { return level_; }
  /// What the last complete level ended with.
  const Array<WideCluster>& clusters() const { return clusters_[level_ - 1]; }

  /// All parts in one draft. The last level ended with one cluster: the root.
  WideDraft join(Array<uint32_t> primitive_ids);

 private:
  /// Where the arrays of a part go.
  struct Offsets {
    uint32_t node, slot, leaf;
  };

  size_t end_of_level(uint32_t level) const {
    return level + 1 < level_ ? level_parts_[level + 1] : parts_.size();
  }
  static uint32_t place_of(const WideCluster& cluster, const Array<Offsets>& offsets) {
    const Offsets& offset = offsets[cluster.part];
    return cluster.child + (cluster.child & kLeafFlag ? offset.leaf : offset.node);
  }
  void copy(size_t number, uint32_t level, const Array<Offsets>& offsets, WideDraft& draft) const;

  Memory& memory_;
  const Parallel& parallel_;
  GrowingArray<WidePart> parts_;
  uint32_t level_ = 0;
  uint32_t level_parts_[kMostLevels];
  Array<WideCluster> clusters_[kMostLevels];
};

}  // namespace kiwami
