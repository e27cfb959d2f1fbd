// SPDX-License-Identifier: Apache-2.0
// Trees over what is no triangle: boxes, with leaves of ids.
#pragma once

#include "bvh/binary_bvh.h"
#include "core/scene_parameters.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// What the parts of a scene are built with.
struct PartPlan {
  const SceneParameters& parameters;
  uint32_t width;  ///< of the nodes: 4, 8 or 16
  Memory& memory;
  const Parallel& parallel;
};

struct PartTree {
  WideTree tree;
  Bounds bounds = Bounds::empty();  ///< empty where nothing can be hit
  uint64_t primitive_count = 0;     ///< that can be hit

  bool is_empty() const { return primitive_count == 0; }
};

/// Builds a tree over boxes by rising id, as the plan's parameters say, and verifies it where they
/// say so. Throws Error.
PartTree build_part_tree(Array<BuildPrimitive> boxes, const PartPlan& plan);

}  // namespace kiwami
