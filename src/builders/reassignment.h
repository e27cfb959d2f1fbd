// SPDX-License-Identifier: Apache-2.0
// Primitives that a split plane cuts go to the cheaper side: the one whose box holds them already,
// whatever side their centroids are on. After the idea of S. Popov, "Algorithms and Data Structures
// for Interactive Ray Tracing on Commodity Hardware", PhD thesis, Saarland University, 2012.
// Departs from judging one primitive after the other: all are judged by the boxes of those that lie
// wholly on one side, so that the judgement does not depend on their order, nor on threads.
#pragma once

#include "builders/sah_bins.h"
#include "builders/sah_split.h"

namespace kiwami {

/// Boxes and counts of two sides.
struct TwoSides {
  VectorBounds box[2] = {VectorBounds::empty(), VectorBounds::empty()};
  uint32_t count[2] = {0, 0};

  void add(uint32_t side, const VectorBounds& primitive) {
    box[side].extend(primitive);
    ++count[side];
  }

  void merge(const TwoSides& other) {
    for (int side = 0; side < 2; ++side) {
      box[side].extend(other.box[side]);
      count[side] += other.count[side];
    }
  }

  /// In blocks; as find_best_plane has it.
  double cost(uint32_t block_size) const {
    double sum = 0.0;
    for (int side = 0; side < 2; ++side) {
      sum += static_cast<double>(box[side].half_area()) * blocks_of(count[side], block_size);
    }
    return sum;
  }
};

/// Takes the marks in place of the plane where they are cheaper.
inline void take_if_cheaper(const TwoSides& marked, uint32_t block_size, SplitDecision& decision) {
  if (marked.count[0] == 0 || marked.count[1] == 0) return;
  const double cost = marked.cost(block_size);
  if (!(cost < decision.cost)) return;
  decision.kind = SplitDecision::kMarks;
  decision.left_count = marked.count[0];
  decision.cost = cost;
}

/// The judgement of the primitives of one node, in two passes over them.
class Reassignment {
 public:
  Reassignment() = default;
  explicit Reassignment(const SplitPlane& plane) : plane_(plane) {}

  /// First pass: adds a primitive that lies wholly on one side.
  void add_pure(const BuildPrimitive& primitive, TwoSides& pure) const {
    const bool is_right = plane_.is_right_of(2.0f * primitive.lower[plane_.axis]);
    const bool is_left = !plane_.is_right_of(2.0f * primitive.upper[plane_.axis]);
    if (is_right || is_left) pure.add(is_right ? 1 : 0, VectorBounds::of(primitive));
  }

  /// Between the passes; false: all primitives are cut, or none.
  bool set_pure(const TwoSides& pure, uint32_t total) {
    pure_ = pure;
    if (pure.count[0] == 0 || pure.count[1] == 0) return false;
    for (int side = 0; side < 2; ++side) area_[side] = pure.box[side].half_area();
    return pure.count[0] + pure.count[1] < total;
  }

  /// Second pass: the side of a primitive.
  uint32_t side_of(const BuildPrimitive& primitive) const {
    if (plane_.is_right_of(2.0f * primitive.lower[plane_.axis])) return 1;
    if (!plane_.is_right_of(2.0f * primitive.upper[plane_.axis])) return 0;
    double cost[2];
    for (int side = 0; side < 2; ++side) {
      VectorBounds box = pure_.box[side];
      box.extend(VectorBounds::of(primitive));
      cost[side] = static_cast<double>(box.half_area()) * (pure_.count[side] + 1.0) +
                   area_[1 - side] * pure_.count[1 - side];
    }
    if (cost[0] == cost[1]) return plane_.is_right(primitive) ? 1 : 0;
    return cost[1] < cost[0] ? 1 : 0;
  }

 private:
  SplitPlane plane_;
  TwoSides pure_;
  double area_[2] = {0.0, 0.0};
};

}  // namespace kiwami
