// SPDX-License-Identifier: Apache-2.0
#include "core/moving_mesh.h"

#include <cmath>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/strided_buffer.h"

namespace kiwami {
namespace {

/// Bytes of a vertex (three floats) and of a triangle (three indices).
constexpr size_t kElementSize = 12;

using ull = unsigned long long;

void check_counts(const kiwami_moving_mesh_desc& desc) {
  if (desc.vertex_count > std::numeric_limits<uint32_t>::max()) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.vertex_count is %llu, expected at most 4294967295",
                ull{desc.vertex_count});
  }
  if (desc.triangle_count > static_cast<uint64_t>(std::numeric_limits<int32_t>::max())) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.triangle_count is %llu, expected at most 2147483647",
                ull{desc.triangle_count});
  }
  if (!desc.indices && desc.triangle_count > desc.vertex_count / 3) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.triangle_count is %llu with desc.indices NULL, expected at most a third of "
                "desc.vertex_count, which is %llu",
                ull{desc.triangle_count}, ull{desc.vertex_count});
  }
}

void check_time(const kiwami_moving_mesh_desc& desc) {
  if (desc.step_count < 2 || desc.step_count > KIWAMI_MAX_TIME_STEPS) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.step_count is %u, expected 2 to %d",
                desc.step_count, int{KIWAMI_MAX_TIME_STEPS});
  }
  // The difference is the last one to become infinite; comparisons with NaN are false.
  if (!(desc.time_begin < desc.time_end && std::isfinite(desc.time_end - desc.time_begin))) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.time_begin is %g and desc.time_end %g, expected finite times, the second "
                "later",
                double{desc.time_begin}, double{desc.time_end});
  }
}

void check(const kiwami_moving_mesh_desc& desc) {
  if (desc.flags & ~uint32_t{KIWAMI_MOVING_MESH_SHARE_BUFFERS}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.flags is 0x%x, expected KIWAMI_MOVING_MESH_* bits", desc.flags);
  }
  if (!desc.vertices && desc.vertex_count != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.vertices is NULL with desc.vertex_count %llu, expected the vertices",
                ull{desc.vertex_count});
  }
  check_stride("vertex_stride", desc.vertex_stride, kElementSize);
  check_stride("index_stride", desc.index_stride, kElementSize);
  check_counts(desc);
  check_time(desc);
}

/// Throws unless all steps end within the address space.
void check_step_extent(const kiwami_moving_mesh_desc& desc, const MovingMeshView& view) {
  check_extent("vertices", desc.vertices, desc.vertex_offset, view.vertex_stride, view.vertex_count,
               kElementSize);
  const size_t one_step = (view.vertex_count - 1) * view.vertex_stride + kElementSize;
  check_extent("time steps of the vertices", desc.vertices, desc.vertex_offset, view.step_stride,
               desc.step_count, one_step);
}

/// The buffers of a checked description.
MovingMeshView view_of(const kiwami_moving_mesh_desc& desc) {
  MovingMeshView view{};
  view.vertex_stride = desc.vertex_stride ? static_cast<size_t>(desc.vertex_stride) : kElementSize;
  view.vertex_count = static_cast<size_t>(desc.vertex_count);
  view.step_stride = desc.step_stride ? static_cast<size_t>(desc.step_stride)
                                      : view.vertex_count * view.vertex_stride;
  view.index_stride = desc.index_stride ? static_cast<size_t>(desc.index_stride) : kElementSize;
  view.triangle_count = static_cast<uint32_t>(desc.triangle_count);
  view.time = {desc.time_begin, desc.time_end, desc.step_count - 1};
  if (view.vertex_count != 0) {
    check_step_extent(desc, view);
    view.vertices = static_cast<const unsigned char*>(desc.vertices) + desc.vertex_offset;
  }
  if (desc.indices) {
    check_extent("indices", desc.indices, desc.index_offset, view.index_stride, view.triangle_count,
                 kElementSize);
    view.indices = static_cast<const unsigned char*>(desc.indices);
    if (view.triangle_count != 0) view.indices += desc.index_offset;
  }
  return view;
}

}  // namespace

MovingMesh* MovingMesh::create(Device& device, const kiwami_moving_mesh_desc& desc) {
  check(desc);
  return make_object<MovingMesh>(device.memory(), device, desc);
}

MovingMesh::MovingMesh(Device& device, const kiwami_moving_mesh_desc& desc)
    : Geometry(device, GeometryKind::kMovingMesh, desc.mask), view_(view_of(desc)) {
  if ((desc.flags & KIWAMI_MOVING_MESH_SHARE_BUFFERS) == 0) copy_buffers();
  check_indices();
}

void MovingMesh::copy_buffers() {
  const size_t step_bytes = view_.vertex_count * kElementSize;
  vertices_ = Array<unsigned char>(device().memory(), (view_.time.segment_count + 1) * step_bytes);
  device().parallel().for_each(view_.time.segment_count + 1, [&](size_t step) {
    const unsigned char* source = view_.vertices + step * view_.step_stride;
    unsigned char* target = vertices_.data() + step * step_bytes;
    for (size_t i = 0; i < view_.vertex_count; ++i) {
      std::memcpy(target + i * kElementSize, source + i * view_.vertex_stride, kElementSize);
    }
  });
  view_.vertices = vertices_.data();
  view_.vertex_stride = kElementSize;
  view_.step_stride = step_bytes;
  if (!view_.indices) return;
  indices_ =
      packed_copy(view_.indices, view_.index_stride, view_.triangle_count, kElementSize, device());
  // A mesh of no triangles keeps the caller's pointer, which is never read.
  if (view_.triangle_count != 0) view_.indices = indices_.data();
  view_.index_stride = kElementSize;
}

void MovingMesh::check_indices() const {
  if (!view_.indices) return;
  for (uint32_t i = 0; i < view_.triangle_count; ++i) {
    uint32_t corner[3];
    std::memcpy(corner, view_.indices + i * view_.index_stride, sizeof corner);
    for (uint32_t k = 0; k < 3; ++k) {
      if (corner[k] < view_.vertex_count) continue;
      throw Error(
          KIWAMI_ERROR_INVALID_ARGUMENT,
          "index %u of triangle %u is %u, expected less than desc.vertex_count, which is %zu", k, i,
          corner[k], view_.vertex_count);
    }
  }
}

}  // namespace kiwami
