// SPDX-License-Identifier: Apache-2.0
// The instances of a committed scene: a part of it.
#pragma once

#include "bvh/binary_bvh.h"
#include "core/instances.h"
#include "core/memory.h"
#include "core/part_tree.h"
#include "math/bounds.h"
#include "optimizers/rebraiding.h"
#include "parallel/parallel.h"
#include "wide/instance_part.h"

namespace kiwami {

class CommittedScene;

/// How far from what it hit the point of a hit may lie, along any axis: 2^-24 (per_origin o +
/// fixed), o being the greatest absolute coordinate of the ray's origin.
struct HitError {
  double per_origin = 0.0;
  double fixed = 0.0;

  void extend(const HitError& other);
  /// Of triangles in a box. See kMargin in kernels/ray-inl.h: 9 (M_a + S_a M_kz), where M is at
  /// most the origin's coordinate and twice the box's greatest, and S at most 1.
  static HitError of_triangles(const Bounds& bounds);
};

/// The records of all instances, the tree over their boxes, and the scenes that they show.
class SceneInstances {
 public:
  SceneInstances() = default;
  ~SceneInstances();
  SceneInstances(const SceneInstances&) = delete;
  SceneInstances& operator=(const SceneInstances&) = delete;

  /// Takes the instances among count geometries, by rising id. Throws Error.
  void build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan);

  bool empty() const { return records_.empty(); }
  size_t count() const { return records_.size(); }
  const WideTree& tree() const { return tree_.tree; }
  bool can_be_hit() const { return !tree_.is_empty(); }
  /// What the instances show; empty where that is nothing.
  const Bounds& bounds() const { return bounds_; }
  const HitError& error() const { return error_; }
  /// The instances on the longest path to a hit.
  uint32_t depth() const { return depth_; }
  ScenePart part() const;

  /// Throws Error(VALIDATION).
  void validate(Memory& memory, const Parallel& parallel) const;

 private:
  /// What an instance shows.
  struct Extent;
  /// The trees of the shown scenes.
  class Trees;

  void collect_prototypes(const AttachedGeometry* geometries, size_t count, uint32_t width,
                          Memory& memory);
  void fill_records(const AttachedGeometry* geometries, size_t count, Memory& memory,
                    const Parallel& parallel);
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
  Bounds bounds_ = Bounds::empty();
  HitError error_;
  uint32_t depth_ = 0;
  uint32_t width_ = 0;
  float far_origin_ = 0.0f;  ///< boxes allow for rays from no farther
};

}  // namespace kiwami
