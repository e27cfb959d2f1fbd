// SPDX-License-Identifier: Apache-2.0
// How a leaf of a tree becomes a block of triangles: stored as one, or gathered from the buffers of
// the meshes by the ids that it holds. Whatever tests triangles sees a LeafBlock.
#pragma once

#include <stddef.h>
#include <stdint.h>

#include "bvh/triangle_source.h"
#include "wide/wide_bvh.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The mesh that an id belongs to.
inline const TriangleMeshView& mesh_of(const SceneView& scene, uint32_t id) {
  uint32_t low = 0, high = scene.range_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (scene.ranges[middle].first_id <= id ? low : high) = middle;
  }
  return scene.meshes[low];
}

inline uint32_t read_index(const unsigned char* from) {
  uint32_t index;
  __builtin_memcpy(&index, from, sizeof index);
  return index;
}

/// Where the vertices of one triangle lie.
inline void find_corners(const TriangleMeshView& mesh, uint32_t primitive,
                         const unsigned char* (&corner)[3]) {
  for (uint32_t k = 0; k < 3; ++k) {
    const size_t index =
        mesh.indices
            ? read_index(mesh.indices + primitive * mesh.index_stride + k * sizeof(uint32_t))
            : size_t{3} * primitive + k;
    corner[k] = mesh.vertices + index * mesh.vertex_stride;
  }
}

/// The step from one element of a buffer to the next. Buffers without gaps are the rule, and a
/// product with a constant is quicker.
struct AnyStrides {
  size_t vertex_stride, index_stride;

  size_t vertex() const { return vertex_stride; }
  size_t index() const { return index_stride; }
};
struct DenseStrides {
  static constexpr size_t vertex() { return 3 * sizeof(float); }
  static constexpr size_t index() { return 3 * sizeof(uint32_t); }
};

/// A block of triangles that is not in the tree, and where the ids stand that it was made from:
/// they tell one leaf block from another.
template <int N>
struct GatheredBlock : LeafBlock<N> {
  const uint32_t* source;
};

/// The vertices of one triangle.
struct Corners {
  float position[3][3];

  float operator()(int k, int axis) const { return position[k][axis]; }
};

inline Corners read_corners(const SceneView& scene, uint32_t id) {
  const TriangleMeshView& mesh = mesh_of(scene, id);
  const unsigned char* corner[3];
  find_corners(mesh, id - mesh.first_id, corner);
  Corners corners;
  for (int k = 0; k < 3; ++k) {
    __builtin_memcpy(corners.position[k], corner[k], sizeof corners.position[k]);
  }
  return corners;
}

/// Triangles of one mesh, which has indices.
template <int N, typename Strides>
inline void gather_indexed(const TriangleMeshView& mesh, const uint32_t (&primitives)[N],
                           Strides strides, LeafBlock<N>& out) {
  const unsigned char* const vertices = mesh.vertices;
  const unsigned char* const indices = mesh.indices;
#pragma GCC unroll 3
  for (size_t k = 0; k < 3; ++k) {
    const unsigned char* rows[N];
#pragma GCC unroll 16
    for (int lane = 0; lane < N; ++lane) {
      const size_t index =
          read_index(indices + primitives[lane] * strides.index() + k * sizeof(uint32_t));
      rows[lane] = vertices + index * strides.vertex();
    }
    vfloat<N> columns[3];
    gather_rows(rows, columns);
    for (int axis = 0; axis < 3; ++axis) store(out.position[k][axis], columns[axis]);
  }
}

/// Triangles of any meshes.
template <int N>
__attribute__((noinline)) void gather_each(const SceneView& scene, const uint32_t (&ids)[N],
                                           LeafBlock<N>& out) {
  for (int lane = 0; lane < N; ++lane) {
    const Corners corners = read_corners(scene, ids[lane]);
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) out.position[k][axis][lane] = corners(k, axis);
    }
  }
}

/// The triangles of an index leaf in those of its lanes that are asked for; the other lanes repeat
/// one of them.
template <int N>
inline void gather_triangles(const SceneView& scene, const IndexBlock<N>& block, uint32_t lanes,
                             GatheredBlock<N>& out) {
  const uint32_t first = block.id[__builtin_ctz(lanes)];
  const TriangleMeshView& mesh = mesh_of(scene, first);
  uint32_t ids[N], primitives[N];
  uint32_t last = 0;
  for (uint32_t lane = 0; lane < N; ++lane) {
    const uint32_t id = ((lanes >> lane) & 1u) != 0 ? block.id[lane] : first;
    ids[lane] = id;
    primitives[lane] = id - mesh.first_id;
    last = primitives[lane] > last ? primitives[lane] : last;
  }
  if (last >= mesh.triangle_count || !mesh.indices) {
    gather_each<N>(scene, ids, out);
  } else if (mesh.vertex_stride == DenseStrides::vertex() &&
             mesh.index_stride == DenseStrides::index()) {
    gather_indexed<N>(mesh, primitives, DenseStrides(), out);
  } else {
    gather_indexed<N>(mesh, primitives, AnyStrides{mesh.vertex_stride, mesh.index_stride}, out);
  }
  for (int lane = 0; lane < N; ++lane) out.id[lane] = ids[lane];
  out.source = block.id;
}

/// Leaves that hold their triangles.
template <int N>
struct StoredLeaves {
  struct Room {};

  static const LeafBlock<N>& triangles_of(const SceneView&, const TreeView& tree,
                                          ChildReference leaf, Room&) {
    return leaf_at<N>(tree.memory, leaf);
  }
  /// Of a triangle in a leaf that triangles_of gave.
  static auto corners_of(const SceneView&, const LeafBlock<N>* leaf, int lane, uint32_t) {
    return [=](int k, int axis) { return leaf->position[k][axis][lane]; };
  }
  /// What rays read.
  static uint64_t bytes_of(const SceneView& scene) { return scene.tree.memory_bytes; }
};

/// Leaves of ids, whose triangles lie in the buffers of the meshes.
template <int N>
struct GatheredLeaves {
  using Room = GatheredBlock<N>;

  static const LeafBlock<N>& triangles_of(const SceneView& scene, const TreeView& tree,
                                          ChildReference leaf, Room& room) {
    gather_triangles<N>(scene, index_leaf_at<N>(tree.memory, leaf), leaf.mask(), room);
    return room;
  }
  static Corners corners_of(const SceneView& scene, const LeafBlock<N>*, int, uint32_t id) {
    return read_corners(scene, id);
  }
  static uint64_t bytes_of(const SceneView& scene) {
    return scene.tree.memory_bytes + scene.mesh_bytes;
  }
};

/// Leaves of either layout.
template <int N>
struct AnyLeaves {
  using Room = GatheredBlock<N>;

  static const LeafBlock<N>& triangles_of(const SceneView& scene, const TreeView& tree,
                                          ChildReference leaf, Room& room) {
    return tree.leaf_layout == LeafLayout::kTriangles
               ? leaf_at<N>(tree.memory, leaf)
               : GatheredLeaves<N>::triangles_of(scene, tree, leaf, room);
  }
};

/// The ids of a leaf of either layout.
template <int N>
inline const uint32_t* leaf_ids_at(const TreeView& tree, ChildReference leaf) {
  return tree.leaf_layout == LeafLayout::kTriangles ? leaf_at<N>(tree.memory, leaf).id
                                                    : index_leaf_at<N>(tree.memory, leaf).id;
}
/// Where they stand, of a leaf of a tree that was made a block of triangles.
template <int N>
inline const uint32_t* leaf_ids_of(const TreeView& tree, const LeafBlock<N>& leaf) {
  return tree.leaf_layout == LeafLayout::kTriangles
             ? leaf.id
             : static_cast<const GatheredBlock<N>&>(leaf).source;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
