// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/motion_part.h"
#include "core/scene_instances.h"
#include "core/shape_part.h"
#include "core/user_geometry.h"

namespace kiwami {

/// What the parts of a saved scene are restored with.
struct RestorePlan {
  uint32_t width;          ///< of the nodes: 4, 8 or 16
  bool copies_primitives;  ///< shapes and moving triangles, to where rays read them faster
  Memory& memory;
  const Parallel& parallel;
};

/// What a scene holds beside static triangles, each kind with a tree of its own.
class SceneParts {
 public:
  SceneParts() = default;
  SceneParts(const SceneParts&) = delete;
  SceneParts& operator=(const SceneParts&) = delete;

  /// Of count geometries by rising geometry_id. Throws Error.
  void build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan);

  /// The same, with trees that were saved. Throws Error(INVALID_FILE) where there are too few or
  /// too many of them.
  void restore(const AttachedGeometry* geometries, size_t count, const SavedParts& saved,
               const RestorePlan& plan);

  /// Adds a part that lies elsewhere, unless it is empty. Its box and its counts are not added.
  void add(const PartTree& tree, const ScenePart& view);

  /// Those that are not empty; they point into this object.
  const ScenePart* views() const { return views_; }
  uint32_t count() const { return count_; }

  const SceneInstances& instances() const { return instances_; }
  const ShapePart& shapes(ShapeKind kind) const { return shapes_[static_cast<uint32_t>(kind)]; }
  const MotionTree& motion() const { return motion_; }

  /// The box of them all.
  Bounds bounds() const;
  /// Primitives that can be hit, and that were skipped.
  uint64_t primitive_count() const;
  uint64_t skipped_count() const;

  /// Checks every invariant of the trees whose boxes are known; throws Error(VALIDATION).
  void validate(Memory& memory, const Parallel& parallel) const;

 private:
  SceneInstances instances_;
  ShapePart shapes_[3] = {ShapePart(ShapeKind::kSphere), ShapePart(ShapeKind::kDisc),
                          ShapePart(ShapeKind::kCurve)};
  UserPart user_;
  MotionTree motion_;
  ScenePart views_[8];
  uint32_t count_ = 0;
};

}  // namespace kiwami
