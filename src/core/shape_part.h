// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/part_tree.h"
#include "core/shapes.h"

namespace kiwami {

struct SavedTree;

/// The shapes of one kind in a scene, and the tree over them.
class ShapePart {
 public:
  explicit ShapePart(ShapeKind kind) : source_{nullptr, 0, kind, nullptr, 0} {}
  ShapePart(const ShapePart&) = delete;
  ShapePart& operator=(const ShapePart&) = delete;

  /// Of those among count geometries that are of the kind, by rising geometry_id. Throws Error.
  void build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan);

  /// The same, with a tree that was saved; nullptr: there is none. Throws Error(INVALID_FILE)
  /// where there should not be one, or should.
  void restore(const AttachedGeometry* geometries, size_t count, const SavedTree* saved,
               Memory& memory);

  /// Copies the shapes into blocks of their leaves' lanes, which rays read faster; build() does it
  /// but for the compact layout.
  void copy_shapes(Memory& memory, const Parallel& parallel);

  /// Points into this object.
  ScenePart view() const;
  const PartTree& tree() const { return tree_; }
  /// Shapes of all these geometries, skipped ones included.
  size_t numbered_count() const { return numbered_count_; }
  /// Checks every invariant of the tree; throws Error(VALIDATION or OUT_OF_MEMORY).
  void validate(Memory& memory, const Parallel& parallel) const;

 private:
  void number(const AttachedGeometry* geometries, size_t count, Memory& memory);
  Array<BuildPrimitive> collect(Memory& memory, const Parallel& parallel) const;

  Array<ShapeView> views_;
  ShapeSource source_;
  Array<float> blocks_;
  size_t numbered_count_ = 0;
  PartTree tree_;
};

}  // namespace kiwami
