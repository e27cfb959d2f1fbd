// SPDX-License-Identifier: Apache-2.0
// The N-wide tree that the kernels traverse, and its file format.
#pragma once

#include <cstddef>
#include <cstdint>

#include "math/vec3.h"

namespace kiwami {

/// A child reference: the index of a wide node, or kLeafFlag and the index of a leaf block. The
/// mask that goes with it says which slots (lanes) of what it points to are its own, so that
/// several parents can share one node or block (leaf-node merging: S. Ogaki, 2016).
constexpr uint32_t kLeafFlag = 0x80000000u;

/// N child boxes, relative to the tree's centre and rounded outwards, by axis: bounds[axis][0] are
/// the lower, bounds[axis][1] the upper ones. An unused slot is in no mask; its box is [+max,
/// -max].
template <int N>
struct alignas(64) WideNode {
  float bounds[3][2][N];
  uint32_t child[N];
  uint16_t mask[N];
};
static_assert(sizeof(WideNode<4>) == 128 && offsetof(WideNode<4>, child) == 96 &&
              offsetof(WideNode<4>, mask) == 112);
static_assert(sizeof(WideNode<8>) == 256 && offsetof(WideNode<8>, child) == 192 &&
              offsetof(WideNode<8>, mask) == 224);
static_assert(sizeof(WideNode<16>) == 512 && offsetof(WideNode<16>, child) == 384 &&
              offsetof(WideNode<16>, mask) == 448);

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

/// Nodes on the longest path from the root to a leaf; bounds the traversal stack.
constexpr uint32_t kMaxWideDepth = 72;

/// What a kernel needs of a tree. Plain data: it crosses from baseline to ISA code.
struct TreeView {
  const void* nodes;     ///< WideNode<N>[]
  const void* leaves;    ///< LeafBlock<N>[]
  uint32_t root;         ///< a child reference
  uint32_t root_mask;    ///< 0: nothing to hit
  Vec3f centre;          ///< boxes are relative to it
  float centre_padding;  ///< 0; four floats are read at once
  Vec3f greatest_bound;  ///< per axis, the greatest absolute box coordinate in the stored frame
  float bound_padding;   ///< 0
};

/// Maps a running triangle id to its geometry. Plain data.
struct GeometryRange {
  uint32_t first_id;  ///< id of the geometry's primitive 0
  uint32_t geometry_id;
  uint32_t mask;
};

/// What a kernel needs of a scene.
struct SceneView {
  TreeView tree;
  const GeometryRange* ranges;  ///< by first_id, rising
  uint32_t range_count;
  uint32_t has_masks;  ///< 0: every geometry's mask is all ones
};

}  // namespace kiwami
