// SPDX-License-Identifier: Apache-2.0
// Chopped binning: references to triangles, cut at the planes between equal bins of a node's box.
#pragma once

#include "builders/sah_bins.h"
#include "builders/sah_split.h"
#include "bvh/triangle_clip.h"

namespace kiwami {

/// Where a reference stands to a plane: on one side where its box is, and on both where the plane
/// runs through the inside of the box.
inline bool reaches_left(const BuildPrimitive& reference, int axis, float plane) {
  return reference.lower[axis] < plane || reference.upper[axis] <= plane;
}
inline bool reaches_right(const BuildPrimitive& reference, int axis, float plane) {
  return reference.upper[axis] > plane;
}

/// The best plane that divides space, or none (cost is infinite).
struct SpatialPlane {
  double cost = std::numeric_limits<double>::infinity();
  int axis = 0;
  float position = 0.0f;
  uint32_t count[2] = {0, 0};  ///< of references on each side, those on both counted twice
  Bounds box[2];               ///< of the parts on each side
};

/// The planes between the bins of one axis.
class BinPlanes {
 public:
  /// false: the box is too thin to have that many different planes inside.
  bool place(const Bounds& box, int axis, uint32_t bin_count) {
    axis_ = axis;
    bin_count_ = bin_count;
    const double lower = box.lower[axis];
    const double extent = static_cast<double>(box.upper[axis]) - lower;
    lower_ = box.lower[axis];
    float last = lower_;
    for (uint32_t i = 1; i < bin_count; ++i) {
      plane_[i] = static_cast<float>(lower + extent * i / bin_count);
      if (!(last < plane_[i])) return false;
      last = plane_[i];
    }
    scale_ = static_cast<float>(bin_count / extent);
    return last < box.upper[axis] && scale_ < std::numeric_limits<float>::infinity();
  }

  float operator[](uint32_t i) const { return plane_[i]; }

  /// The bins that a reference reaches: those right of which plane first, left of which plane
  /// last + 1 is, as reaches_left and reaches_right say.
  void range_of(const BuildPrimitive& reference, uint32_t& first, uint32_t& last) const {
    last = guess(reference.upper[axis_]);
    while (last > 0 && !reaches_right(reference, axis_, plane_[last])) --last;
    while (last + 1 < bin_count_ && reaches_right(reference, axis_, plane_[last + 1])) ++last;
    first = std::min(guess(reference.lower[axis_]), last);
    while (first > 0 && reaches_left(reference, axis_, plane_[first])) --first;
    while (first < last && !reaches_left(reference, axis_, plane_[first + 1])) ++first;
  }

 private:
  uint32_t guess(float position) const {
    const float bin = (position - lower_) * scale_;
    return bin >= static_cast<float>(bin_count_) ? bin_count_ - 1
           : bin > 0.0f                          ? static_cast<uint32_t>(bin)
                                                 : 0;
  }

  int axis_ = 0;
  uint32_t bin_count_ = 0;
  float lower_ = 0.0f, scale_ = 0.0f;
  float plane_[SahBins::kMaxBins];  ///< [i]: between the bins i - 1 and i
};

/// The boxes of what lies in each bin of one axis, and how many references begin and end there.
class SpatialBins {
 public:
  SpatialBins(const BinPlanes& planes, int axis, uint32_t bin_count)
      : planes_(planes), axis_(axis), bin_count_(bin_count) {
    std::fill_n(box_, bin_count, Bounds::empty());
    std::fill_n(begin_count_, bin_count, 0u);
    std::fill_n(end_count_, bin_count, 0u);
  }

  /// corners_of(id, corner) gives a triangle's vertices: asked for only where it is cut.
  template <typename CornersOf>
  void add(const BuildPrimitive& reference, CornersOf&& corners_of) {
    uint32_t first, last;
    planes_.range_of(reference, first, last);
    ++begin_count_[first];
    ++end_count_[last];
    Bounds rest = reference.bounds();
    if (first != last) {
      Vec3f corner[3];
      corners_of(reference.id, corner);
      for (uint32_t bin = first; bin < last && !rest.is_empty(); ++bin) {
        Bounds side[2];
        split_triangle(corner, rest, axis_, planes_[bin + 1], side);
        if (!side[0].is_empty()) box_[bin].extend(side[0]);
        rest = side[1];
      }
    }
    if (!rest.is_empty()) box_[last].extend(rest);
  }

  /// The least (cost, plane) and an earlier best, of the planes that leave less than all references
  /// on each side and make at most spare new ones.
  void find_best_plane(uint32_t total, uint32_t spare, uint32_t block_size,
                       SpatialPlane& best) const {
    Bounds right_box[SahBins::kMaxBins];
    Bounds box = Bounds::empty();
    for (uint32_t bin = bin_count_ - 1; bin > 0; --bin) {
      box.extend(box_[bin]);
      right_box[bin] = box;
    }
    box = Bounds::empty();
    uint32_t left = 0, right = total;
    for (uint32_t bin = 1; bin < bin_count_; ++bin) {
      box.extend(box_[bin - 1]);
      left += begin_count_[bin - 1];
      right -= end_count_[bin - 1];
      if (left == total || right == total || left == 0 || right == 0) continue;
      if (left + right - total > spare) continue;
      const double cost =
          static_cast<double>(box.half_area()) * blocks_of(left, block_size) +
          static_cast<double>(right_box[bin].half_area()) * blocks_of(right, block_size);
      if (cost >= best.cost) continue;
      best = {cost, axis_, planes_[bin], {left, right}, {box, right_box[bin]}};
    }
  }

 private:
  const BinPlanes& planes_;
  int axis_;
  uint32_t bin_count_;
  Bounds box_[SahBins::kMaxBins];
  uint32_t begin_count_[SahBins::kMaxBins], end_count_[SahBins::kMaxBins];
};

}  // namespace kiwami
