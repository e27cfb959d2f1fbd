// SPDX-License-Identifier: Apache-2.0
#include "core/mesh_buffers.h"

#include <atomic>
#include <cmath>
#include <limits>

#include "core/error.h"
#include "core/strided_buffer.h"
#include "kiwami/moving_mesh.h"

namespace kiwami {
namespace {

/// Triangles that one task checks.
constexpr size_t kBlockSize = 16384;

using ull = unsigned long long;

size_t stride_or_packed(uint64_t stride) {
  return stride != 0 ? static_cast<size_t>(stride) : kMeshElementSize;
}

/// Which of a triangle's three indices is at or beyond vertex_count; 3: none.
uint32_t invalid_corner(const uint32_t corner[3], size_t vertex_count) {
  uint32_t k = 0;
  while (k < 3 && corner[k] < vertex_count) ++k;
  return k;
}

}  // namespace

void check_fields(const MeshBuffers& buffers) {
  if (!buffers.vertices && buffers.vertex_count != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.vertices is NULL with desc.vertex_count %llu, expected the vertices",
                ull{buffers.vertex_count});
  }
  check_stride("vertex_stride", buffers.vertex_stride, kMeshElementSize);
  check_stride("index_stride", buffers.index_stride, kMeshElementSize);
  if (buffers.vertex_count > std::numeric_limits<uint32_t>::max()) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.vertex_count is %llu, expected at most 4294967295",
                ull{buffers.vertex_count});
  }
  if (buffers.triangle_count > static_cast<uint64_t>(std::numeric_limits<int32_t>::max())) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.triangle_count is %llu, expected at most 2147483647",
                ull{buffers.triangle_count});
  }
  if (!buffers.indices && buffers.triangle_count > buffers.vertex_count / 3) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.triangle_count is %llu with desc.indices NULL, expected at most a third of "
                "desc.vertex_count, which is %llu",
                ull{buffers.triangle_count}, ull{buffers.vertex_count});
  }
}

TriangleMeshView view_of(const MeshBuffers& buffers) {
  TriangleMeshView view{};
  view.vertex_stride = stride_or_packed(buffers.vertex_stride);
  view.vertex_count = static_cast<size_t>(buffers.vertex_count);
  view.index_stride = stride_or_packed(buffers.index_stride);
  view.triangle_count = static_cast<uint32_t>(buffers.triangle_count);
  check_extent("vertices", buffers.vertices, buffers.vertex_offset, view.vertex_stride,
               view.vertex_count, kMeshElementSize);
  if (view.vertex_count != 0) {
    view.vertices = static_cast<const unsigned char*>(buffers.vertices) + buffers.vertex_offset;
  }
  if (buffers.indices) {
    check_extent("indices", buffers.indices, buffers.index_offset, view.index_stride,
                 view.triangle_count, kMeshElementSize);
    view.indices = static_cast<const unsigned char*>(buffers.indices);
    if (view.triangle_count != 0) view.indices += buffers.index_offset;
  }
  return view;
}

void check_indices(const TriangleMeshView& mesh, const Device& device) {
  if (!mesh.indices) return;
  // The lowest faulty triangle is reported, whichever thread finds one first.
  std::atomic<uint32_t> faulty{mesh.triangle_count};
  device.parallel().for_blocks(mesh.triangle_count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      uint32_t corner[3];
      mesh.indices_of(static_cast<uint32_t>(i), corner);
      if (invalid_corner(corner, mesh.vertex_count) == 3) continue;
      uint32_t lowest = faulty.load(std::memory_order_relaxed);
      while (i < lowest && !faulty.compare_exchange_weak(lowest, static_cast<uint32_t>(i))) {
      }
      return;
    }
  });
  const uint32_t triangle = faulty.load();
  if (triangle == mesh.triangle_count) return;
  uint32_t corner[3];
  mesh.indices_of(triangle, corner);
  const uint32_t k = invalid_corner(corner, mesh.vertex_count);
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "index %u of triangle %u is %u, expected less than desc.vertex_count, which is %zu",
              k, triangle, corner[k % 3], mesh.vertex_count);
}

void check_time_steps(uint32_t step_count, float time_begin, float time_end) {
  if (step_count < 2 || step_count > KIWAMI_MAX_TIME_STEPS) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.step_count is %u, expected 2 to %d",
                step_count, int{KIWAMI_MAX_TIME_STEPS});
  }
  // The difference is the last one to become infinite; comparisons with NaN are false.
  if (!(time_begin < time_end && std::isfinite(time_end - time_begin))) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.time_begin is %g and desc.time_end %g, expected finite times, the second "
                "later",
                double{time_begin}, double{time_end});
  }
}

}  // namespace kiwami
