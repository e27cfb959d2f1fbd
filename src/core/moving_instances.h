// SPDX-License-Identifier: Apache-2.0
// The instances of a committed scene that move: a part of it.
#pragma once

#include "core/instance_bounds.h"
#include "core/instances.h"
#include "core/moving_tree.h"

namespace kiwami {

class CommittedScene;

/// Their steps, and the tree over their moving boxes.
class MovingInstances {
 public:
  MovingInstances() = default;
  MovingInstances(const MovingInstances&) = delete;
  MovingInstances& operator=(const MovingInstances&) = delete;

  /// Makes room for arrays, of so many floats of steps in all (step_floats_of).
  void reserve(Memory& memory, size_t array_count, size_t step_floats);
  static size_t step_floats_of(const Instances& instances) {
    return size_t{instances.count()} * (instances.time().segment_count + 1) *
           step_size_of(instances.format());
  }
  /// Takes the steps of an array, whose instances have numbers from first on. False where one is
  /// singular.
  bool add(const Instances& instances, uint32_t first, const Parallel& parallel);
  /// After the last array: builds the tree. All instances of the scene show these scenes, by the
  /// prototypes in their records. Throws Error.
  void build(const InstancePart& all, CommittedScene* const* scenes, const PartPlan& plan);

  bool empty() const { return array_count_ == 0; }
  /// Whether an instance moves, by its number.
  bool contains(uint32_t number) const {
    if (array_count_ == 0) return false;
    const MovingArray& array = array_of(arrays_.data(), array_count_, number);
    return array.first <= number && number - array.first < array.count;
  }
  bool can_be_hit() const { return !tree_.tree().is_empty(); }
  size_t tree_bytes() const { return tree_.bytes(); }
  /// What they show at any time; empty where that is nothing.
  const Bounds& bounds() const { return bounds_; }
  const HitError& error() const { return error_; }
  /// Points into this object.
  ScenePart part() const;

  /// Throws Error(VALIDATION).
  void validate(CommittedScene* const* scenes, Memory& memory, const Parallel& parallel) const;

 private:
  class Source;

  Array<MovingArray> arrays_;
  Array<float> steps_;  ///< of one array after the other
  uint32_t array_count_ = 0;
  size_t used_floats_ = 0;
  MovingTree tree_;
  MovingInstancePart data_{};
  Bounds bounds_ = Bounds::empty();
  HitError error_;
  float far_origin_ = 0.0f;  ///< boxes allow for rays from no farther
};

}  // namespace kiwami
