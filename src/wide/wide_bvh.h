// SPDX-License-Identifier: Apache-2.0
// The N-wide tree that the kernels traverse, and its file format.
#pragma once

#include <cstddef>
#include <cstdint>

#include "math/vec3.h"

namespace kiwami {

/// What a slot refers to, in one word, so that it is read and moved at once: where in the tree's
/// memory a node or leaf block lies, what it is, and the mask of those of its slots (lanes) that
/// are this slot's own, so that several parents can share one node or block (leaf-node merging: S.
/// Ogaki, 2016). Unused slots hold 0. Both sizes are even, which leaves bit 0 of an offset free.
struct ChildReference {
  static constexpr uint64_t kLeafBit = 1;
  static constexpr int kMaskShift = 48;

  uint64_t bits;

  /// To what lies offset bytes into the tree's memory.
  static ChildReference to_node(uint64_t offset, uint32_t mask) {
    return {offset | uint64_t{mask} << kMaskShift};
  }
  static ChildReference to_leaf(uint64_t offset, uint32_t mask) {
    return {offset | kLeafBit | uint64_t{mask} << kMaskShift};
  }
  bool is_leaf() const { return (bits & kLeafBit) != 0; }
  uint32_t mask() const { return static_cast<uint32_t>(bits >> kMaskShift); }
  /// One of these where it is known which applies: neither takes a step to clear the leaf bit.
  uint64_t node_offset() const { return bits & ((uint64_t{1} << kMaskShift) - 1); }
  uint64_t leaf_offset() const { return node_offset() - kLeafBit; }
  uint64_t offset() const { return node_offset() & ~kLeafBit; }
  bool operator==(const ChildReference&) const = default;
};

/// N child boxes, relative to the tree's centre and rounded outwards, by axis: bounds[axis][0] are
/// the lower, bounds[axis][1] the upper ones. An unused slot is in no mask; its box is [+max,
/// -max].
template <int N>
struct alignas(64) WideNode {
  float bounds[3][2][N];
  ChildReference child[N];
};
static_assert(sizeof(WideNode<4>) == 128 && offsetof(WideNode<4>, child) == 96);
static_assert(sizeof(WideNode<8>) == 256 && offsetof(WideNode<8>, child) == 192);
static_assert(sizeof(WideNode<16>) == 512 && offsetof(WideNode<16>, child) == 384);

/// W triangles with their original vertices: position[vertex][axis][lane]. The id numbers the
/// triangles of all geometries through, by geometry and then by primitive, so that the order of
/// ids is the order of (geometry, primitive). An unused lane is in no mask; its vertices are NaN.
template <int W>
struct alignas(32) LeafBlock {
  float position[3][3][W];
  uint32_t id[W];
};
static_assert(sizeof(LeafBlock<4>) == 160 && sizeof(LeafBlock<8>) == 320 &&
              sizeof(LeafBlock<16>) == 640);

/// W ids alone, of primitives whose shape is found elsewhere: the compact layout of triangles, and
/// trees over boxes. An unused lane is in no mask; its id is KIWAMI_INVALID_ID.
template <int W>
struct alignas(4 * W) IndexBlock {
  uint32_t id[W];
};
static_assert(sizeof(IndexBlock<4>) == 16 && sizeof(IndexBlock<8>) == 32 &&
              sizeof(IndexBlock<16>) == 64);

/// What all leaf blocks of a tree are.
enum class LeafLayout : uint32_t { kTriangles = 0, kIndices = 1 };

/// The size of a leaf block, and where in it the ids stand.
constexpr size_t leaf_block_bytes(LeafLayout layout, uint32_t width) {
  return width * (layout == LeafLayout::kTriangles ? sizeof(LeafBlock<4>) : sizeof(IndexBlock<4>)) /
         4;
}
constexpr size_t leaf_ids_offset(LeafLayout layout, uint32_t width) {
  return layout == LeafLayout::kTriangles ? width * offsetof(LeafBlock<4>, id) / 4 : 0;
}

/// Nodes on the longest path from the root to a leaf; bounds the traversal stack.
constexpr uint32_t kMaxWideDepth = 72;

template <int N>
const WideNode<N>& node_at(const unsigned char* memory, ChildReference reference) {
  return *reinterpret_cast<const WideNode<N>*>(memory + reference.node_offset());
}
template <int N>
const LeafBlock<N>& leaf_at(const unsigned char* memory, ChildReference reference) {
  return *reinterpret_cast<const LeafBlock<N>*>(memory + reference.leaf_offset());
}
template <int N>
const IndexBlock<N>& index_leaf_at(const unsigned char* memory, ChildReference reference) {
  return *reinterpret_cast<const IndexBlock<N>*>(memory + reference.leaf_offset());
}

/// What a kernel needs of a tree. Plain data: it crosses from baseline to ISA code.
struct TreeView {
  const unsigned char* memory;  ///< WideNode<N>[], then LeafBlock<N>[] or IndexBlock<N>[]
  ChildReference root;          ///< with a mask of 0: nothing to hit
  Vec3f centre;                 ///< boxes are relative to it
  float centre_padding;         ///< 0; four floats are read at once
  Vec3f greatest_bound;     ///< per axis, the greatest absolute box coordinate in the stored frame
  float bound_padding;      ///< 0
  uint32_t has_duplicates;  ///< 1: a triangle may stand in several leaves
  LeafLayout leaf_layout;
  uint64_t memory_bytes;
};

/// Maps a running triangle id to its geometry. Plain data.
struct GeometryRange {
  uint32_t first_id;  ///< id of the geometry's primitive 0
  uint32_t geometry_id;
  uint32_t mask;
};

/// What the leaves of a part's tree hold.
enum class PartKind : uint32_t {
  kInstances,
  kShapes,
  kUser,
  kMovingTriangles,
  kMeshes,
  kMovingInstances
};

/// Whether the boxes of the tree's nodes are of no time in particular.
constexpr bool has_moving_boxes(PartKind kind) {
  return kind == PartKind::kMovingTriangles || kind == PartKind::kMovingInstances;
}

/// A tree of a scene beside that of its triangles, with leaves of ids. Plain data.
struct ScenePart {
  PartKind kind;
  TreeView tree;
  const void* data;  ///< by kind: InstancePart, MeshPart
  // Of a ray whose origin has a coordinate beyond far_origin, the slabs are wider by
  // far_origin_margin times what it is beyond.
  float far_origin, far_origin_margin;
};

/// The opacity micromaps of a mesh. Plain data.
struct OpacityView {
  const unsigned char* maps;
  size_t map_bytes;         ///< of one
  const uint32_t* indices;  ///< the map of each triangle; nullptr: that of its number
  uint32_t level;
  uint32_t bits;  ///< of a micro-triangle; 0: the mesh has no maps
};

struct TriangleMeshView;

/// What a kernel needs of a scene.
struct SceneView {
  TreeView tree;                ///< of the static triangles
  const GeometryRange* ranges;  ///< by first_id, rising
  uint32_t range_count;
  uint32_t has_masks;  ///< 0: every geometry's mask is all ones
  uint32_t part_count;
  const ScenePart* parts;                    ///< everything but the static triangles; none is empty
  const TriangleMeshView* meshes = nullptr;  ///< of each range, for leaves of ids alone
  uint64_t mesh_bytes = 0;                   ///< what rays may read of their buffers
  const OpacityView* opacities = nullptr;    ///< of each range; nullptr: there are none
};

}  // namespace kiwami
