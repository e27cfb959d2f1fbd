// SPDX-License-Identifier: Apache-2.0
// The instances of a committed scene: a part of it.
#pragma once

#include "bvh/binary_bvh.h"
#include "core/instance_bounds.h"
#include "core/instances.h"
#include "core/memory.h"
#include "core/moving_instances.h"
#include "core/part_tree.h"
#include "math/bounds.h"
#include "optimizers/rebraiding.h"
#include "parallel/parallel.h"
#include "wide/instance_part.h"

namespace kiwami {

class CommittedScene;
struct SavedInstances;
struct SavedMovingInstances;
struct SavedParts;

/// The records of all instances, the tree over their boxes, and the scenes that they show.
class SceneInstances {
 public:
  SceneInstances() = default;
  ~SceneInstances();
  SceneInstances(const SceneInstances&) = delete;
  SceneInstances& operator=(const SceneInstances&) = delete;

  /// Takes the instances among count geometries, by rising id. Throws Error.
  void build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan);

  /// The same, of what was saved. Throws Error(INVALID_FILE) where that is of other sizes.
  void restore(const AttachedGeometry* geometries, size_t count, const SavedParts& saved,
               uint32_t width, Memory& memory);
  /// What restore takes, beside the tree.
  SavedInstances saved() const;

  bool empty() const { return records_.empty(); }
  size_t count() const { return records_.size(); }
  /// Those that move have a tree of their own.
  const MovingInstances& moving() const { return moving_; }
  size_t tree_bytes() const {
    return tree_.tree.node_bytes() + tree_.tree.leaf_bytes() + moving_.tree_bytes();
  }
  /// Whether one can that rests.
  bool can_be_hit() const { return !tree_.is_empty(); }
  /// What the instances show; empty where that is nothing.
  Bounds bounds() const {
    Bounds bounds = bounds_;
    bounds.extend(moving_.bounds());
    return bounds;
  }
  HitError error() const {
    HitError error = error_;
    error.extend(moving_.error());
    return error;
  }
  /// Of those that rest.
  const PartTree& part_tree() const { return tree_; }
  /// Those that the geometries show, one after the other.
  CommittedScene& shown(size_t prototype) const { return *scenes_[prototype]; }
  /// The instances on the longest path to a hit.
  uint32_t depth() const { return depth_; }
  /// Of those that rest.
  ScenePart part() const;

  /// Throws Error(VALIDATION).
  void validate(Memory& memory, const Parallel& parallel) const;

 private:
  /// What an instance shows.
  struct Extent;
  /// The trees of the shown scenes.
  class Trees;

  void set_rebraiding(uint32_t mode, double budget);
  void show();
  void collect_prototypes(const AttachedGeometry* geometries, size_t count, uint32_t width,
                          Memory& memory);
  void fill_records(const AttachedGeometry* geometries, size_t count, Memory& memory,
                    const Parallel& parallel);
  /// Takes the steps of those that move from a file, and says how many instances there are in all.
  /// Throws Error(INVALID_FILE) where there are too few or too many steps.
  uint64_t place_moving(const AttachedGeometry* geometries, size_t count,
                        const SavedMovingInstances& saved, Memory& memory);
  void measure(Memory& memory, const Parallel& parallel);
  Array<BraidReference> make_references(Memory& memory, const Parallel& parallel) const;
  Extent extent_of(uint32_t instance) const;

  Array<InstanceRecord> records_;
  Array<uint32_t> masks_;  ///< empty: all ones
  Array<Prototype> prototypes_;
  Array<CommittedScene*> scenes_;  ///< of the prototypes; references
  Array<InstanceStart> starts_;    ///< of re-braided references
  uint32_t rebraid_mode_ = 0;
  RebraidConfig rebraid_config_;
  PartTree tree_;
  InstancePart data_{};
  MovingInstances moving_;
  Bounds bounds_ = Bounds::empty();
  HitError error_;
  uint32_t depth_ = 0;
  uint32_t width_ = 0;
  float far_origin_ = 0.0f;  ///< boxes allow for rays from no farther
};

}  // namespace kiwami
