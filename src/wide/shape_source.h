// SPDX-License-Identifier: Apache-2.0
// Spheres, discs and curve segments as commits and kernels see them: views of the geometries'
// buffers. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kiwami {

enum class ShapeKind : uint32_t { kSphere, kDisc, kCurve };

/// The shapes of one geometry. The buffers may lie at any address; no byte beyond the last element
/// is read.
struct ShapeView {
  const unsigned char* points;  ///< four floats each: x, y, z, radius
  size_t point_stride;
  size_t point_count;
  const unsigned char* normals;  ///< discs: three floats each
  size_t normal_stride;
  const unsigned char* indices;  ///< curves: a uint32 each, the first of two points that follow
                                 ///< each other; nullptr: segment i begins at point i
  size_t index_stride;
  uint32_t count;     ///< of shapes
  uint32_t first_id;  ///< the running id of shape 0
  uint32_t geometry_id;
  uint32_t mask;
};

/// All geometries of one kind in a scene, by rising first_id, without gaps, and the shapes of each
/// leaf block of their tree as its lanes have them, so that rays need not look for them in the
/// buffers: shape_rows(kind) rows of floats. Lanes that hold none are zero.
struct ShapeSource {
  const ShapeView* views;
  uint32_t view_count;
  ShapeKind kind;
  const float* blocks;  ///< nullptr: rays read the buffers
  uint64_t leaf_begin;  ///< of the leaf blocks, in bytes into the tree's memory
};

/// Rows of a block: x, y, z and radius of a point; then those of a segment's second point, or the
/// normal of a disc.
// Always inlined: objects of several instruction sets must not share one copy.
__attribute__((always_inline)) constexpr uint32_t shape_rows(ShapeKind kind) {
  return kind == ShapeKind::kSphere ? 4 : kind == ShapeKind::kDisc ? 7 : 8;
}
constexpr uint32_t kMostShapeRows = 8;

}  // namespace kiwami
