// SPDX-License-Identifier: Apache-2.0
// Trees over what moves: of each node the boxes at the start and at the end of every segment of
// time. Where steps of what moves are so far apart that boxes between them are much larger than what
// they hold, segments are divided: the time splits of S. Woop, A. Afra, C. Benthin, "STBVH: A
// Spatial-Temporal BVH for Efficient Multi-Segment Motion Blur", HPG 2017. It departs from that in
// that all of a tree is divided, by the mean area of its boxes, and the nodes stay the same.
#pragma once

#include <span>

#include "core/linear_bounds.h"
#include "core/part_tree.h"
#include "wide/moving_boxes.h"

namespace kiwami {

struct SavedTree;

/// Where the primitives of a moving tree are.
class MovingSource {
 public:
  /// During a segment of some steps: boxes that move linearly around the primitive, with room
  /// for the rounding of what is interpolated. Empty where it does not exist then.
  virtual LinearBounds during(uint32_t id, const TimeSteps& steps, uint32_t segment) const = 0;
  /// At a time; empty where it does not exist then.
  virtual Bounds at(uint32_t id, float time) const = 0;

 protected:
  ~MovingSource() = default;
};

/// A tree whose nodes stay and whose boxes move.
class MovingTree {
 public:
  MovingTree() = default;
  MovingTree(const MovingTree&) = delete;
  MovingTree& operator=(const MovingTree&) = delete;

  /// Builds over boxes of no time in particular, by rising id, with boxes at these steps, or more
  /// of them. Extent holds all primitives at all times. Throws Error.
  void build(Array<BuildPrimitive> boxes, const Bounds& extent, const TimeSteps& time,
             const MovingSource& source, const PartPlan& plan);

  /// The same, of a tree that was saved and what bounds() was, whose size says into how many each of
  /// the segments is divided. Throws Error(INVALID_FILE) where it is that of no division.
  void restore(const SavedTree& saved, const TimeSteps& time,
               std::span<const unsigned char> bounds);

  /// Its bounds are the extent.
  const PartTree& tree() const { return tree_; }
  /// Points into this object.
  MovingBoxes boxes() const { return {time_, bounds_.data(), tree_.tree.node_count}; }
  /// MotionBounds of its nodes, segment after segment.
  std::span<const unsigned char> bounds() const { return {bounds_.data(), bounds_.size()}; }
  size_t bytes() const {
    return tree_.tree.node_bytes() + tree_.tree.leaf_bytes() + bounds_.bytes();
  }

  /// Checks every invariant of the tree over the boxes that it was built over, and its boxes at and
  /// between all steps; throws Error(VALIDATION or OUT_OF_MEMORY).
  void validate(const Array<BuildPrimitive>& boxes, const MovingSource& source, Memory& memory,
                const Parallel& parallel) const;

 private:
  template <int N>
  void bound(const MovingSource& source, const PartPlan& plan);
  template <int N>
  void fill(const MovingSource& source, Memory& memory, const Parallel& parallel);
  template <int N>
  bool is_promising(const MovingSource& source, Memory& memory, const Parallel& parallel) const;
  template <int N>
  double mean_area(Memory& memory, const Parallel& parallel) const;
  template <int N>
  void check(const MovingSource& source, const Parallel& parallel) const;

  PartTree tree_;
  TimeSteps time_{};
  Array<unsigned char> bounds_;
};

/// Steps over the time of all of count, as short as the shortest of theirs.
TimeSteps common_steps(const TimeSteps* steps, size_t count);

}  // namespace kiwami
