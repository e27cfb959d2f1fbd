// SPDX-License-Identifier: Apache-2.0
// The choice of a node's split from its bins.
#pragma once

#include <bit>

#include "builders/sah_bins.h"
#include "builders/sah_config.h"

namespace kiwami {

/// What becomes of a node.
struct SplitDecision {
  enum Kind : uint32_t {
    kLeaf,
    kPlane,  ///< by the bins of an axis
    kIndex,  ///< the first left_count primitives go left
    kMarks   ///< by BuildPrimitive::reserved, 1 for the right side
  };
  Kind kind;
  int axis;
  uint32_t last_left_bin;
  uint32_t left_count;
  double cost = 0.0;  ///< of the areas and blocks of both sides, where the node has an area
};

/// The best plane of one set of bins, or none (cost is infinite).
struct BestPlane {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0;
  uint32_t last_left_bin = 0;
  uint32_t left_count = 0;
};

inline uint32_t blocks_of(uint32_t count, uint32_t block_size) {
  return (count + block_size - 1) / block_size;
}

/// The least (cost, axis, bin) over the planes of one axis and an earlier best.
/// A node of no area costs the same wherever it is cut: there, balance decides.
inline void find_best_plane(const SahBins& bins, uint32_t bin_count, int axis, uint32_t total,
                            uint32_t block_size, bool has_area, BestPlane& best) {
  float right_area[SahBins::kMaxBins];
  VectorBounds right = VectorBounds::empty();
  uint32_t right_count = 0;
  for (uint32_t bin = bin_count - 1; bin > 0; --bin) {
    right.extend(bins.box[bin][axis]);
    right_count += bins.count[bin][axis];
    right_area[bin - 1] = right_count ? right.half_area() : 0.0f;
  }
  VectorBounds left = VectorBounds::empty();
  uint32_t left_count = 0;
  for (uint32_t bin = 0; bin + 1 < bin_count; ++bin) {
    left.extend(bins.box[bin][axis]);
    left_count += bins.count[bin][axis];
    if (left_count == 0 || bins.count[bin][axis] == 0) continue;
    if (left_count == total) break;
    right_count = total - left_count;
    // In double: an area may be as large as 2^124, and a product with a count would overflow.
    const double cost =
        has_area ? static_cast<double>(left.half_area()) * blocks_of(left_count, block_size) +
                       static_cast<double>(right_area[bin]) * blocks_of(right_count, block_size)
                 : static_cast<double>(left_count > right_count ? left_count : right_count);
    if (cost < best.cost) best = {cost, axis, bin, left_count};
  }
}

/// Half of the primitives, in whole blocks where both sides then have some.
inline SplitDecision split_by_index(uint32_t count, uint32_t block_size) {
  const uint32_t half = count / 2;
  const uint32_t aligned = blocks_of(half, block_size) * block_size;
  return {SplitDecision::kIndex, 0, 0, aligned < count ? aligned : half};
}

/// The levels that halving takes from count primitives to one.
inline uint32_t halving_levels(uint32_t count) {
  return static_cast<uint32_t>(std::bit_width(count - 1));
}

/// The decision for nodes that need no bins; false: fill the bins and ask decide_by_bins.
inline bool decide_without_bins(uint32_t count, uint32_t depth, const SahConfig& config,
                                SplitDecision& decision) {
  const bool can_be_leaf = count <= config.max_leaf_size;
  const bool no_split_pays =
      blocks_of(count, config.block_size) * config.leaf_cost <= config.node_cost;
  if (count == 1 || (can_be_leaf && no_split_pays)) {
    decision = {SplitDecision::kLeaf, 0, 0, 0};
    return true;
  }
  // From here on only halving keeps within the greatest depth. Whoever is above the limit has at
  // least one level to spare for any split, so depth + halving_levels never passes kMaxDepth.
  if (depth + halving_levels(count) >= BinaryBvh::kMaxDepth) {
    decision = {can_be_leaf ? SplitDecision::kLeaf : SplitDecision::kIndex, 0, 0, count / 2};
    return true;
  }
  if (count == 2 && !can_be_leaf) {
    decision = {SplitDecision::kIndex, 0, 0, 1};
    return true;
  }
  return false;
}

/// Split or leaf by the surface area heuristic with costs in blocks.
inline SplitDecision decide_by_bins(const SahBins& bins, const BinMapping& mapping,
                                    const RangeBounds& bounds, uint32_t count,
                                    const SahConfig& config) {
  const double area = bounds.geometry.half_area();
  BestPlane best;
  for (int axis = 0; axis < 3; ++axis) {
    if (mapping.is_flat(axis)) continue;
    find_best_plane(bins, mapping.bin_count, axis, count, config.block_size, area > 0.0, best);
  }
  const bool can_be_leaf = count <= config.max_leaf_size;
  const bool found = best.left_count != 0;
  const double split_cost = config.node_cost * area + config.leaf_cost * best.cost;
  const double leaf_cost = config.leaf_cost * area * blocks_of(count, config.block_size);
  if (can_be_leaf && !(found && area > 0.0 && split_cost < leaf_cost)) {
    return {SplitDecision::kLeaf, 0, 0, 0};
  }
  if (!found) return split_by_index(count, config.block_size);
  return {SplitDecision::kPlane, best.axis, best.last_left_bin, best.left_count,
          area > 0.0 ? best.cost : 0.0};
}

}  // namespace kiwami
