// SPDX-License-Identifier: Apache-2.0
// The moving triangles of a scene as kernels see them. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>

#include "wide/moving_boxes.h"
#include "wide/time_steps.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// One mesh. The buffers may lie at any address; no byte beyond the last element is read.
struct MovingMeshView {
  const unsigned char* vertices;  ///< the first vertex of the first step
  size_t vertex_stride;
  size_t step_stride;
  size_t vertex_count;
  const unsigned char* indices;  ///< nullptr: vertices 3i, 3i + 1, 3i + 2
  size_t index_stride;
  uint32_t triangle_count;
  TimeSteps time;
  uint32_t first_id;  ///< the running id of triangle 0
  uint32_t geometry_id;
  uint32_t mask;
};

/// Rows of floats of a leaf block: the corners of its triangles, axis by axis, at the first step,
/// then at the second.
constexpr uint32_t kMotionBlockRows = 18;

/// All moving meshes of a scene, by rising first_id, without gaps, and what their tree lacks: its
/// own boxes are of no time in particular.
struct MotionPart {
  const MovingMeshView* meshes;
  uint32_t mesh_count;
  MovingBoxes boxes;
  SceneView scene;      ///< what a query needs to know of the triangles: ranges, masks
  const float* blocks;  ///< kMotionBlockRows rows of each leaf block, where all meshes have two
                        ///< steps, so that rays need not read the buffers; nullptr: they do
  uint64_t leaf_begin;  ///< of the leaf blocks, in bytes into the tree's memory
};

}  // namespace kiwami
