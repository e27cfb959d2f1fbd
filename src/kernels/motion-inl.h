// SPDX-License-Identifier: Apache-2.0
// What moves: boxes and vertices at the time of the ray.
//
// Boxes move with what they hold, linearly over a segment of time, as those of S. Woop, A. Afra,
// C. Benthin, "STBVH: A Spatial-Temporal BVH for Efficient Multi-Segment Motion Blur", HPG 2017. It
// departs from it in that one tree serves all segments of time: each has boxes of its own for the
// same nodes.
#pragma once

#include "kernels/node-inl.h"
#include "wide/motion_part.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// As test_boxes, of the boxes at a time. Their rounding is in the boxes (core/linear_bounds.cpp, core/instance_bounds.cpp).
template <int N>
__attribute__((always_inline)) inline uint32_t test_moving_boxes(const MotionBounds<N>& node,
                                                                 float fraction,
                                                                 const SlabRay<N>& ray, float best,
                                                                 vfloat<N>& entry) {
  const vfloat<N> of_start = broadcast<N>(1.0f - fraction), of_end = broadcast<N>(fraction);
  const auto planes = [&](size_t offset) __attribute__((always_inline)) {
    const auto* start = reinterpret_cast<const unsigned char*>(node.bounds[0]);
    const auto* end = reinterpret_cast<const unsigned char*>(node.bounds[1]);
    return multiply_add(load<N>(reinterpret_cast<const float*>(end + offset)), of_end,
                        load<N>(reinterpret_cast<const float*>(start + offset)) * of_start);
  };
  const auto near_distance = [&](int axis) __attribute__((always_inline)) {
    return multiply_add(planes(ray.planes.near[axis]), ray.reciprocal[axis], ray.near_offset[axis]);
  };
  const auto far_distance = [&](int axis) __attribute__((always_inline)) {
    return multiply_add(planes(ray.planes.far[axis]), ray.reciprocal[axis], ray.far_offset[axis]);
  };
  entry = max(max(near_distance(0), near_distance(1)),
              max(near_distance(2), broadcast<N>(ray.nearest)));
  const vfloat<N> exit =
      min(min(far_distance(0), far_distance(1)), min(far_distance(2), broadcast<N>(best)));
  return less_equal(entry, exit);
}

/// The boxes of one segment of time. False where a time lies outside of all.
template <int N>
struct MovingBoxReader {
  const MotionBounds<N>* bounds;
  float fraction;

  bool begin(const MovingBoxes& boxes, float time) {
    TimePlace place;
    if (!place_in_time(boxes.time, time, place)) return false;
    bounds =
        reinterpret_cast<const MotionBounds<N>*>(boxes.bounds) + place.segment * boxes.node_count;
    fraction = place.fraction;
    return true;
  }

  uint32_t test(ChildReference node, const SlabRay<N>& slabs, float best, vfloat<N>& entry) const {
    return test_moving_boxes(bounds[node.node_offset() / sizeof(WideNode<N>)], fraction, slabs,
                             best, entry);
  }
};

inline const MovingMeshView& mesh_of(const MotionPart& part, uint32_t id) {
  uint32_t low = 0, high = part.mesh_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (part.meshes[middle].first_id <= id ? low : high) = middle;
  }
  return part.meshes[low];
}

/// Puts the corners of a triangle at both ends of a segment of time into a lane.
template <int N>
inline void read_corners(const MovingMeshView& mesh, uint32_t primitive, uint32_t segment, int lane,
                         float (&start)[3][3][N], float (&end)[3][3][N]) {
  uint32_t corner[3] = {3 * primitive, 3 * primitive + 1, 3 * primitive + 2};
  if (mesh.indices) {
    __builtin_memcpy(corner, mesh.indices + primitive * mesh.index_stride, sizeof corner);
  }
  for (int k = 0; k < 3; ++k) {
    const unsigned char* at =
        mesh.vertices + segment * mesh.step_stride + corner[k] * mesh.vertex_stride;
    float a[3], b[3];
    __builtin_memcpy(a, at, sizeof a);
    __builtin_memcpy(b, at + mesh.step_stride, sizeof b);
    for (int axis = 0; axis < 3; ++axis) {
      start[k][axis][lane] = a[axis];
      end[k][axis][lane] = b[axis];
    }
  }
}

/// The triangles of a leaf at a time: those lanes that exist then. The others hold garbage.
template <int N>
inline uint32_t freeze_leaf(const MotionPart& part, const IndexBlock<N>& block, uint32_t lanes,
                            float time, LeafBlock<N>& frozen) {
  float start[3][3][N], end[3][3][N], of_start[N], of_end[N];
  uint32_t existing = 0;
  for (int lane = 0; lane < N; ++lane) {
    // Lanes of others are filled as well, so that no number is read that nobody wrote.
    const bool is_own = ((lanes >> lane) & 1u) != 0;
    const uint32_t id = block.id[is_own ? lane : __builtin_ctz(lanes)];
    const MovingMeshView& mesh = mesh_of(part, id);
    TimePlace place = {0, 0.0f};
    if (place_in_time(mesh.time, time, place) && is_own) existing |= 1u << lane;
    of_start[lane] = 1.0f - place.fraction;
    of_end[lane] = place.fraction;
    frozen.id[lane] = id;
    read_corners<N>(mesh, id - mesh.first_id, place.segment, lane, start, end);
  }
  const vfloat<N> start_weight = load<N>(of_start), end_weight = load<N>(of_end);
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      store(frozen.position[k][axis],
            start_weight * load<N>(start[k][axis]) + end_weight * load<N>(end[k][axis]));
    }
  }
  return existing;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
