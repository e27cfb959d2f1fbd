// SPDX-License-Identifier: Apache-2.0
// The triangles of a scene as the stages below the scene see them: views of the meshes' buffers.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include "kiwami/base.h"
#include "math/bounds.h"

namespace kiwami {

/// Whether a triangle with these corners is one that rays can meet: none of them may be NaN,
/// infinite or beyond KIWAMI_MAX_COORDINATE.
inline bool can_be_hit(const Vec3f corner[3]) {
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      // A comparison with NaN is false, so NaN is out of range as well.
      if (!(std::fabs(corner[k][axis]) <= KIWAMI_MAX_COORDINATE)) return false;
    }
  }
  return true;
}

/// One mesh. The buffers may lie at any address; no byte beyond the last element is read.
struct TriangleMeshView {
  const unsigned char* vertices;  ///< the first vertex
  size_t vertex_stride;
  size_t vertex_count;
  const unsigned char* indices;  ///< the first triangle; nullptr: vertices 3i, 3i + 1, 3i + 2
  size_t index_stride;
  uint32_t triangle_count;
  uint32_t first_id;  ///< the running id of triangle 0
  uint32_t geometry_id;
  uint32_t mask;

  /// From the first to the last element of its buffers, whatever stands between elements.
  size_t bytes() const {
    return vertex_count * vertex_stride + (indices ? triangle_count * index_stride : 0);
  }

  void indices_of(uint32_t primitive, uint32_t corner[3]) const {
    if (indices) {
      std::memcpy(corner, indices + primitive * index_stride, 3 * sizeof(uint32_t));
    } else {
      for (uint32_t k = 0; k < 3; ++k) corner[k] = 3 * primitive + k;
    }
  }

  void corners_of(uint32_t primitive, Vec3f corner[3]) const {
    uint32_t index[3];
    indices_of(primitive, index);
    read_vertices(index, corner);
  }

  /// For indices that may have changed since they were checked: throws Error(INVALID_ARGUMENT) for
  /// one at or beyond the vertex count.
  void checked_indices_of(uint32_t primitive, uint32_t index[3]) const {
    indices_of(primitive, index);
    for (uint32_t k = 0; k < 3; ++k) {
      if (index[k] >= vertex_count) refuse_index(k, primitive, index[k]);
    }
  }
  void checked_corners_of(uint32_t primitive, Vec3f corner[3]) const {
    uint32_t index[3];
    checked_indices_of(primitive, index);
    read_vertices(index, corner);
  }

  const unsigned char* vertex(uint32_t index) const { return vertices + index * vertex_stride; }

  /// Ask for cache lines that will be read soon; indices must be right. Inlined by force: GCC takes
  /// a function that only prefetches for one without effects and drops it.
  __attribute__((always_inline)) void prefetch_indices(uint32_t primitive) const {
    if (indices) __builtin_prefetch(indices + primitive * index_stride);
  }
  __attribute__((always_inline)) void prefetch_vertices(uint32_t primitive) const {
    uint32_t index[3];
    indices_of(primitive, index);
    for (const uint32_t k : index) __builtin_prefetch(vertex(k));
  }

 private:
  void read_vertices(const uint32_t index[3], Vec3f corner[3]) const {
    for (int k = 0; k < 3; ++k) std::memcpy(&corner[k], vertex(index[k]), sizeof(Vec3f));
  }
  [[noreturn]] void refuse_index(uint32_t corner, uint32_t primitive, uint32_t index) const;
};

/// All meshes of a scene, by rising first_id, without gaps.
struct TriangleSource {
  const TriangleMeshView* meshes;
  uint32_t mesh_count;

  const TriangleMeshView& mesh_of(uint32_t id) const {
    uint32_t low = 0, high = mesh_count;
    while (high - low > 1) {
      const uint32_t middle = low + (high - low) / 2;
      (meshes[middle].first_id <= id ? low : high) = middle;
    }
    return meshes[low];
  }

  void corners_of(uint32_t id, Vec3f corner[3]) const {
    const TriangleMeshView& mesh = mesh_of(id);
    mesh.corners_of(id - mesh.first_id, corner);
  }

  __attribute__((always_inline)) void prefetch_indices(uint32_t id) const {
    const TriangleMeshView& mesh = mesh_of(id);
    mesh.prefetch_indices(id - mesh.first_id);
  }
  __attribute__((always_inline)) void prefetch_vertices(uint32_t id) const {
    const TriangleMeshView& mesh = mesh_of(id);
    mesh.prefetch_vertices(id - mesh.first_id);
  }
};

}  // namespace kiwami
