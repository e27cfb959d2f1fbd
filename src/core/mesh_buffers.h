// SPDX-License-Identifier: Apache-2.0
// What descriptions of triangle meshes have in common, and its checks. All throw
// Error(INVALID_ARGUMENT or TOO_LARGE).
#pragma once

#include "bvh/triangle_source.h"
#include "core/device.h"

namespace kiwami {

/// Bytes of a vertex (three floats) and of a triangle (three indices).
constexpr size_t kMeshElementSize = 12;

/// The fields of this name of a description.
struct MeshBuffers {
  const void* vertices;
  uint64_t vertex_offset, vertex_stride, vertex_count;
  const void* indices;
  uint64_t index_offset, index_stride, triangle_count;
};

template <typename Desc>
MeshBuffers buffers_of(const Desc& desc) {
  return {desc.vertices, desc.vertex_offset, desc.vertex_stride, desc.vertex_count,
          desc.indices,  desc.index_offset,  desc.index_stride,  desc.triangle_count};
}

/// Pointers, strides and counts.
void check_fields(const MeshBuffers& buffers);

/// The buffers behind checked fields, of which also the extents are checked.
TriangleMeshView view_of(const MeshBuffers& buffers);

/// That each index names a vertex: the lowest triangle that has another one is reported.
void check_indices(const TriangleMeshView& mesh, const Device& device);

/// The time of what moves.
void check_time_steps(uint32_t step_count, float time_begin, float time_end);

}  // namespace kiwami
