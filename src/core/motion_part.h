// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "core/moving_mesh.h"
#include "core/moving_tree.h"
#include "wide/motion_part.h"

namespace kiwami {

struct SavedTree;

/// The moving triangles of a scene, the tree over them, and its boxes at all times.
class MotionTree final : private MovingSource {
 public:
  MotionTree() = default;
  MotionTree(const MotionTree&) = delete;
  MotionTree& operator=(const MotionTree&) = delete;

  /// Of the moving meshes among count geometries, by rising geometry_id. Throws Error.
  void build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan);

  /// The same, with a tree that was saved, and its boxes at all times; nullptr: there is none.
  /// Throws Error(INVALID_FILE) where there should not be one, or should, or of other sizes.
  void restore(const AttachedGeometry* geometries, size_t count, const SavedTree* saved,
               std::span<const unsigned char> bounds, Memory& memory);

  /// Copies triangles of two steps into blocks of their leaves' lanes, which rays read faster;
  /// build() does it but for the compact layout.
  void copy_triangles(Memory& memory, const Parallel& parallel);

  /// Points into this object.
  ScenePart view() const;
  /// Its bounds hold the triangles at all times.
  const PartTree& tree() const { return tree_.tree(); }
  /// MotionBounds of its nodes, segment after segment.
  std::span<const unsigned char> bounds() const { return tree_.bounds(); }
  /// Triangles of all these meshes, skipped ones included.
  size_t numbered_count() const { return numbered_count_; }

  /// Checks every invariant of the tree, and the boxes at and between all steps; throws
  /// Error(VALIDATION or OUT_OF_MEMORY).
  void validate(Memory& memory, const Parallel& parallel) const;

 private:
  void number(const AttachedGeometry* geometries, size_t count, Memory& memory);
  /// What kernels need beside the tree. Returns the steps that its own are, or divide.
  TimeSteps show(Memory& memory);
  /// The mean boxes of those triangles that can be hit; extent becomes the box of all at all times.
  Array<BuildPrimitive> collect(Memory& memory, const Parallel& parallel, Bounds& extent) const;
  LinearBounds during(uint32_t id, const TimeSteps& steps, uint32_t segment) const override;
  Bounds at(uint32_t id, float time) const override;

  Array<MovingMeshView> meshes_;
  Array<GeometryRange> ranges_;
  Bounds extent_ = Bounds::empty();  ///< of all triangles at all times
  MotionPart data_{};
  Array<float> blocks_;
  size_t numbered_count_ = 0;
  MovingTree tree_;
};

}  // namespace kiwami
