// SPDX-License-Identifier: Apache-2.0
#include "core/moving_mesh.h"

#include <cstring>

#include "core/error.h"
#include "core/linear_bounds.h"
#include "core/mesh_buffers.h"
#include "core/strided_buffer.h"

namespace kiwami {
namespace {

void check(const kiwami_moving_mesh_desc& desc) {
  if (desc.flags & ~uint32_t{KIWAMI_MOVING_MESH_SHARE_BUFFERS}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.flags is 0x%x, expected KIWAMI_MOVING_MESH_* bits", desc.flags);
  }
  check_fields(buffers_of(desc));
  check_time_steps(desc.step_count, desc.time_begin, desc.time_end);
}

/// The buffers of a checked description, whose steps end within the address space.
MovingMeshView view_of(const kiwami_moving_mesh_desc& desc) {
  const TriangleMeshView first = view_of(buffers_of(desc));
  MovingMeshView view{};
  view.vertices = first.vertices;
  view.vertex_stride = first.vertex_stride;
  view.vertex_count = first.vertex_count;
  view.step_stride = desc.step_stride ? static_cast<size_t>(desc.step_stride)
                                      : view.vertex_count * view.vertex_stride;
  view.indices = first.indices;
  view.index_stride = first.index_stride;
  view.triangle_count = first.triangle_count;
  view.time = {desc.time_begin, desc.time_end, desc.step_count - 1};
  if (view.vertex_count == 0) return view;
  const size_t one_step = (view.vertex_count - 1) * view.vertex_stride + kMeshElementSize;
  check_extent("time steps of the vertices", desc.vertices, desc.vertex_offset, view.step_stride,
               desc.step_count, one_step);
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
  check_indices(first_step_of(view_), device);
}

MovingMesh::MovingMesh(Device& device, FileImage& image, const MovingMeshView& view,
                       bool is_trusted)
    : Geometry(device, image, GeometryKind::kMovingMesh, view.mask), view_(view) {
  check_time_steps(view.time.segment_count + 1, view.time.begin, view.time.end);
  vertices_ = Array<unsigned char>::borrow(const_cast<unsigned char*>(view.vertices),
                                           (view.time.segment_count + 1) * view.step_stride);
  if (view.indices) {
    indices_ = Array<unsigned char>::borrow(const_cast<unsigned char*>(view.indices),
                                            view.triangle_count * kMeshElementSize);
  }
  if (!is_trusted) check_indices(first_step_of(view_), device);
}

void MovingMesh::copy_buffers() {
  const size_t step_bytes = view_.vertex_count * kMeshElementSize;
  vertices_ = Array<unsigned char>(device().memory(), (view_.time.segment_count + 1) * step_bytes);
  device().parallel().for_each(view_.time.segment_count + 1, [&](size_t step) {
    const unsigned char* source = view_.vertices + step * view_.step_stride;
    unsigned char* target = vertices_.data() + step * step_bytes;
    for (size_t i = 0; i < view_.vertex_count; ++i) {
      std::memcpy(target + i * kMeshElementSize, source + i * view_.vertex_stride,
                  kMeshElementSize);
    }
  });
  view_.vertices = vertices_.data();
  view_.vertex_stride = kMeshElementSize;
  view_.step_stride = step_bytes;
  if (!view_.indices) return;
  indices_ = packed_copy(view_.indices, view_.index_stride, view_.triangle_count, kMeshElementSize,
                         device());
  // A mesh of no triangles keeps the caller's pointer, which is never read.
  if (view_.triangle_count != 0) view_.indices = indices_.data();
  view_.index_stride = kMeshElementSize;
}

}  // namespace kiwami
