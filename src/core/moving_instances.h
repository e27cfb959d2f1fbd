// SPDX-License-Identifier: Apache-2.0
// The instances of a committed scene that move: a part of it.
#pragma once

#include <span>

#include "core/instance_bounds.h"
#include "core/instances.h"
#include "core/moving_tree.h"

namespace kiwami {

class CommittedScene;
struct SavedMovingInstances;
struct SavedTree;

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

  /// Instead of reserve, add and build: takes the steps of arrays from a file, and which of them are
  /// regular. As many may be placed.
  void borrow(const SavedMovingInstances& saved, Memory& memory);
  /// Places an array, whose instances have numbers from first on, behind the one before.
  void place(const Instances& instances, uint32_t first);
  /// The tree over them; nullptr: there is none. Throws Error(INVALID_FILE) where there should not
  /// be one, or of other sizes.
  void restore(const InstancePart& all, const SavedMovingInstances& saved, const SavedTree* tree,
               Memory& memory);
  /// What restore takes, beside the tree.
  SavedMovingInstances saved() const;

  bool empty() const { return array_count_ == 0; }
  /// The arrays, by rising number of their first instance.
  std::span<const MovingArray> arrays() const { return {arrays_.data(), array_count_}; }
  /// Whether an instance moves, by its number.
  bool contains(uint32_t number) const {
    if (array_count_ == 0) return false;
    const MovingArray& array = array_of(arrays_.data(), array_count_, number);
    return array.first <= number && number - array.first < array.count;
  }
  bool can_be_hit() const { return !tree_.tree().is_empty(); }
  size_t tree_bytes() const { return tree_.bytes(); }
  const PartTree& tree() const { return tree_.tree(); }
  /// What they show at any time; empty where that is nothing.
  const Bounds& bounds() const { return bounds_; }
  const HitError& error() const { return error_; }
  /// Points into this object.
  ScenePart part() const;

  /// Throws Error(VALIDATION).
  void validate(CommittedScene* const* scenes, Memory& memory, const Parallel& parallel) const;

 private:
  class Source;

  /// What kernels need beside the tree. Returns the steps that its own are, or divide.
  TimeSteps show(const InstancePart& all, Memory& memory);

  Array<MovingArray> arrays_;
  Array<float> steps_;       ///< of one array after the other
  Array<uint32_t> regular_;  ///< MovingArray::is_regular of each
  uint32_t array_count_ = 0;
  size_t used_floats_ = 0;
  MovingTree tree_;
  MovingInstancePart data_{};
  Bounds bounds_ = Bounds::empty();
  HitError error_;
  float far_origin_ = 0.0f;  ///< boxes allow for rays from no farther
};

}  // namespace kiwami
