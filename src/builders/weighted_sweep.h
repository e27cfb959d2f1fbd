// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>

#include "bvh/binary_bvh.h"

namespace kiwami {

/// A tree over whole subtrees by the surface area heuristic: every position along every axis is
/// tried (I. Wald, S. Boulos, P. Shirley, "Ray Tracing Deformable Scenes Using Dynamic Bounding
/// Volume Hierarchies", TOG 26(1), 2007), and each side costs its area times the primitives in it.
/// One thread; the items are sorted once along each axis, and their orders divided.
class WeightedSweep {
 public:
  struct Item {
    BinaryNode node;
    uint32_t weight;  ///< primitives
  };

  WeightedSweep(const Item* items, uint32_t count, Memory& memory)
      : items_(items),
        is_right_(memory, count),
        right_cost_(memory, count),
        scratch_(memory, count) {
    for (int axis = 0; axis < 3; ++axis) {
      order_[axis] = Array<uint32_t>(memory, count);
      for (uint32_t i = 0; i < count; ++i) order_[axis][i] = i;
      std::sort(order_[axis].begin(), order_[axis].end(), [&](uint32_t a, uint32_t b) {
        const float centre_a = doubled_centre(a, axis), centre_b = doubled_centre(b, axis);
        return centre_a != centre_b ? centre_a < centre_b : a < b;
      });
    }
  }

  /// The root. Other nodes go to the pairs of slots that take_pair() gives, the index of the first.
  template <typename TakePair>
  BinaryNode build(BinaryBvh& bvh, TakePair&& take_pair) {
    return split(0, static_cast<uint32_t>(is_right_.size()), 0, bvh, take_pair);
  }

 private:
  /// Below this depth items are halved, so that recursion stays shallow.
  static constexpr uint32_t kSweepDepth = 48;

  struct Split {
    double cost;
    uint32_t larger_weight;  ///< of the two sides: decides among equal costs
    int axis;
    uint32_t left_count;

    bool operator<(const Split& other) const {
      return cost < other.cost || (cost == other.cost && larger_weight < other.larger_weight);
    }
  };

  float doubled_centre(uint32_t item, int axis) const {
    const Bounds& bounds = items_[item].node.bounds;
    return bounds.lower[axis] + bounds.upper[axis];
  }

  void sweep(uint32_t begin, uint32_t end, int axis, Split& best) {
    const uint32_t* const order = order_[axis].data();
    Bounds right = Bounds::empty();
    uint32_t total = 0;
    for (uint32_t i = end; i-- > begin;) {
      right.extend(items_[order[i]].node.bounds);
      total += items_[order[i]].weight;
      right_cost_[i] = static_cast<double>(right.half_area()) * total;
    }
    Bounds left = Bounds::empty();
    uint32_t weight = 0;
    for (uint32_t i = begin; i + 1 < end; ++i) {
      left.extend(items_[order[i]].node.bounds);
      weight += items_[order[i]].weight;
      const Split split = {static_cast<double>(left.half_area()) * weight + right_cost_[i + 1],
                           std::max(weight, total - weight), axis, i + 1 - begin};
      if (split < best) best = split;
    }
  }

  /// Keeps the orders within both sides.
  void divide(uint32_t begin, uint32_t end, const Split& best) {
    const uint32_t* const chosen = order_[best.axis].data();
    for (uint32_t i = begin; i < end; ++i) is_right_[chosen[i]] = i - begin >= best.left_count;
    for (int axis = 0; axis < 3; ++axis) {
      if (axis == best.axis) continue;
      uint32_t* const order = order_[axis].data();
      uint32_t left = begin, right = 0;
      for (uint32_t i = begin; i < end; ++i) {
        const uint32_t item = order[i];
        (is_right_[item] != 0 ? scratch_[right++] : order[left++]) = item;
      }
      std::copy_n(scratch_.begin(), right, order + left);
    }
  }

  template <typename TakePair>
  BinaryNode split(uint32_t begin, uint32_t end, uint32_t depth, BinaryBvh& bvh,
                   TakePair& take_pair) {
    if (end - begin == 1) return items_[order_[0][begin]].node;
    Split best = {std::numeric_limits<double>::infinity(), ~0u, 0, (end - begin) / 2};
    if (depth < kSweepDepth) {
      for (int axis = 0; axis < 3; ++axis) sweep(begin, end, axis, best);
    }
    divide(begin, end, best);
    const uint32_t first = take_pair(), middle = begin + best.left_count;
    // One after the other: both take pairs.
    bvh.nodes[first] = split(begin, middle, depth + 1, bvh, take_pair);
    bvh.nodes[first + 1] = split(middle, end, depth + 1, bvh, take_pair);
    Bounds bounds = bvh.nodes[first].bounds;
    bounds.extend(bvh.nodes[first + 1].bounds);
    return {bounds, first, 0};
  }

  const Item* items_;
  Array<uint32_t> order_[3];
  Array<uint8_t> is_right_;
  Array<double> right_cost_;
  Array<uint32_t> scratch_;
};

}  // namespace kiwami
