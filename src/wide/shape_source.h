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

/// All geometries of one kind in a scene, by rising first_id, without gaps.
struct ShapeSource {
  const ShapeView* views;
  uint32_t view_count;
  ShapeKind kind;
};

}  // namespace kiwami
