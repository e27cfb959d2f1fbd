// SPDX-License-Identifier: Apache-2.0
// What a file holds of a committed scene beside its geometries. Its memory is that of the file.
#pragma once

#include <span>

#include "core/part_tree.h"
#include "core/scene_instances.h"
#include "wide/instance_part.h"

namespace kiwami {

/// A tree that was saved. Plain data.
struct SavedTree {
  TreeView view;
  uint32_t width;
  uint32_t depth;
  uint64_t node_count;
  uint64_t leaf_block_count;
  uint64_t used_slots;
  uint64_t used_lanes;
  uint64_t primitive_count;  ///< that can be hit
  double sah_cost;
  Bounds bounds;

  /// Over the memory of the file.
  WideTree tree() const;
  PartTree part() const { return {tree(), bounds, primitive_count}; }
};

/// Throws Error(INVALID_FILE) unless a part of so many primitives, some of which may not be hit,
/// has a tree of no more, and one of none has no tree.
void check_saved_part(const char* name, uint64_t numbered_count, const SavedTree* saved);

/// What MovingInstances makes, beside its tree.
struct SavedMovingInstances {
  std::span<const float> steps;       ///< as MovingArray has them
  std::span<const uint32_t> regular;  ///< by array: MovingArray::is_regular
  std::span<const unsigned char> boxes;
  Bounds bounds;
  HitError error;
  float far_origin;
};

/// What SceneInstances makes, beside its tree.
struct SavedInstances {
  std::span<const InstanceRecord> records;
  std::span<const uint32_t> masks;        ///< of each; empty: all ones
  std::span<const InstanceStart> starts;  ///< empty: not re-braided
  Bounds bounds;
  HitError error;
  float far_origin;
  uint32_t rebraid_mode;
  double rebraid_budget;
  SavedMovingInstances moving;
};

/// Parts whose geometries have nothing in them have no tree: nullptr.
struct SavedParts {
  const SavedTree* instance_tree = nullptr;
  const SavedTree* moving_instance_tree = nullptr;
  const SavedTree* shape_trees[3] = {};  ///< by ShapeKind
  const SavedTree* motion_tree = nullptr;
  const SavedTree* mesh_tree = nullptr;          ///< over the meshes that have a tree each
  std::span<const SavedTree> mesh_trees;         ///< of these
  std::span<const unsigned char> motion_bounds;  ///< as MotionPart has them
  SavedInstances instances;
};

struct SavedScene {
  Reference<FileImage> image;
  const SavedTree& tree;  ///< of the static triangles
  const SavedParts& parts;
  double build_seconds;
  size_t borrowed_bytes;  ///< what it takes of the file beside the geometries' buffers
};

}  // namespace kiwami
