// SPDX-License-Identifier: Apache-2.0
// The moving triangles of a scene as kernels see them. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>

#include "wide/wide_bvh.h"

namespace kiwami {

/// Equal steps of time.
struct TimeSteps {
  float begin, end;
  uint32_t segment_count;  ///< steps but one
};

/// Where a time lies among steps.
struct TimePlace {
  uint32_t segment;
  float fraction;  ///< of the way through it, 0 to 1
};

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

/// Boxes of the children of a node that grow linearly over a segment of time: those at its start,
/// then those at its end, each as in WideNode.
template <int N>
struct alignas(64) MotionBounds {
  float bounds[2][3][2][N];
};
static_assert(sizeof(MotionBounds<4>) == 192 && sizeof(MotionBounds<8>) == 384 &&
              sizeof(MotionBounds<16>) == 768);

/// All moving meshes of a scene, by rising first_id, without gaps, and what their tree lacks: its
/// own boxes are of no time in particular.
struct MotionPart {
  const MovingMeshView* meshes;
  uint32_t mesh_count;
  TimeSteps time;               ///< of the boxes
  const unsigned char* bounds;  ///< MotionBounds<N> of each node, segment after segment
  uint64_t node_count;
  SceneView scene;  ///< what a query needs to know of the triangles: ranges, masks
};

}  // namespace kiwami
