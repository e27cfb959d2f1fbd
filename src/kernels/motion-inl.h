// SPDX-License-Identifier: Apache-2.0
// What moves: boxes and vertices at the time of the ray.
//
// Boxes move with what they hold, linearly over a segment of time, as those of S. Woop, A. Afra,
// C. Benthin, "STBVH: A Spatial-Temporal BVH for Efficient Multi-Segment Motion Blur", HPG 2017. It
// departs from it in that one tree serves all segments of time: each has boxes of its own for the
// same nodes.
#pragma once

#include "kernels/leaf-inl.h"
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

  __attribute__((always_inline)) uint32_t test(ChildReference node, const SlabRay<N>& slabs,
                                               float best, vfloat<N>& entry) const {
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

/// The triangles of one mesh, which has indices, at a place in its time.
template <int N, typename Strides>
inline void freeze_indexed(const MovingMeshView& mesh, const uint32_t (&primitives)[N],
                           Strides strides, const TimePlace& place, LeafBlock<N>& frozen) {
  const unsigned char* const vertices = mesh.vertices + place.segment * mesh.step_stride;
  const float of_start = 1.0f - place.fraction;
#pragma GCC unroll 3
  for (size_t k = 0; k < 3; ++k) {
    const unsigned char* rows[N];
#pragma GCC unroll 16
    for (int lane = 0; lane < N; ++lane) {
      const size_t index =
          read_index(mesh.indices + primitives[lane] * strides.index() + k * sizeof(uint32_t));
      rows[lane] = vertices + index * strides.vertex();
    }
    vfloat<N> columns[3];
    gather_between(rows, mesh.step_stride, of_start, place.fraction, columns);
    for (int axis = 0; axis < 3; ++axis) store(frozen.position[k][axis], columns[axis]);
  }
}

/// Triangles of any meshes: those lanes that exist at a time.
template <int N>
__attribute__((noinline)) uint32_t freeze_each(const MotionPart& part, uint32_t lanes, float time,
                                               LeafBlock<N>& frozen) {
  float start[3][3][N], end[3][3][N], of_start[N], of_end[N];
  uint32_t existing = 0;
  for (int lane = 0; lane < N; ++lane) {
    const MovingMeshView& mesh = mesh_of(part, frozen.id[lane]);
    TimePlace place = {0, 0.0f};
    if (place_in_time(mesh.time, time, place)) existing |= 1u << lane;
    of_start[lane] = 1.0f - place.fraction;
    of_end[lane] = place.fraction;
    read_corners<N>(mesh, frozen.id[lane] - mesh.first_id, place.segment, lane, start, end);
  }
  const vfloat<N> start_weight = load<N>(of_start), end_weight = load<N>(of_end);
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      store(frozen.position[k][axis],
            start_weight * load<N>(start[k][axis]) + end_weight * load<N>(end[k][axis]));
    }
  }
  return existing & lanes;
}

/// Makes the triangles of leaves as they are at the time of a ray.
template <int N>
class LeafFreezer {
 public:
  LeafFreezer(const MotionPart& part, float time) : part_(part), time_(time) {}

  /// Returns the lanes that exist then. The other lanes are those of any triangles.
  uint32_t freeze(const TreeView& tree, const IndexBlock<N>& block, uint32_t lanes,
                  LeafBlock<N>& frozen) {
    __builtin_memcpy(frozen.id, block.id, sizeof frozen.id);
    const uint32_t first = block.id[__builtin_ctz(lanes)];
    const MovingMeshView& mesh = part_.mesh_count == 1 ? part_.meshes[0] : mesh_of(part_, first);
    if (part_.mesh_count != 1 && !is_of_one_mesh(block, lanes, mesh)) {
      return freeze_any(first, lanes, frozen);
    }
    if (&mesh != mesh_) choose(mesh);
    if (!exists_) return 0;
    if (part_.blocks) {
      freeze_block(tree, block, frozen);
      return lanes;
    }
    if (!mesh_->indices) return freeze_any(first, lanes, frozen);
    // Lanes that are not asked for may be empty, or of another mesh.
    const uint32_t of_first = first - mesh_->first_id;
    uint32_t primitives[N];
#pragma GCC unroll 16
    for (int lane = 0; lane < N; ++lane) {
      const uint32_t primitive = block.id[lane] - mesh_->first_id;
      primitives[lane] = primitive < mesh_->triangle_count ? primitive : of_first;
    }
    if (is_dense_) {
      freeze_indexed<N>(*mesh_, primitives, DenseStrides(), place_, frozen);
    } else {
      freeze_indexed<N>(*mesh_, primitives, AnyStrides{mesh_->vertex_stride, mesh_->index_stride},
                        place_, frozen);
    }
    return lanes;
  }

 private:
  void choose(const MovingMeshView& mesh) {
    mesh_ = &mesh;
    exists_ = place_in_time(mesh.time, time_, place_);
    is_dense_ =
        mesh.vertex_stride == DenseStrides::vertex() && mesh.index_stride == DenseStrides::index();
  }

  /// Of meshes of two steps, whose corners stand in a block of their own.
  void freeze_block(const TreeView& tree, const IndexBlock<N>& block, LeafBlock<N>& frozen) const {
    const auto* const at = reinterpret_cast<const unsigned char*>(block.id);
    // A leaf block has one row, of ids.
    const uint64_t place = static_cast<uint64_t>(at - tree.memory) - part_.leaf_begin;
    const float* row = part_.blocks + place / sizeof(uint32_t) * kMotionBlockRows;
    const vfloat<N> of_start = broadcast<N>(1.0f - place_.fraction);
    const vfloat<N> of_end = broadcast<N>(place_.fraction);
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis, row += N) {
        store(frozen.position[k][axis], of_start * load<N>(row) + of_end * load<N>(row + 9 * N));
      }
    }
  }

  static bool is_of_one_mesh(const IndexBlock<N>& block, uint32_t lanes,
                             const MovingMeshView& mesh) {
    for (; lanes; lanes &= lanes - 1) {
      if (block.id[__builtin_ctz(lanes)] - mesh.first_id >= mesh.triangle_count) return false;
    }
    return true;
  }

  uint32_t freeze_any(uint32_t first, uint32_t lanes, LeafBlock<N>& frozen) const {
    for (uint32_t lane = 0; lane < N; ++lane) {
      if (((lanes >> lane) & 1u) == 0) frozen.id[lane] = first;
    }
    return freeze_each<N>(part_, lanes, time_, frozen);
  }

  const MotionPart& part_;
  float time_;
  const MovingMeshView* mesh_ = nullptr;  ///< the last one
  TimePlace place_{};                     ///< in its time
  bool exists_ = false;
  bool is_dense_ = false;
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
