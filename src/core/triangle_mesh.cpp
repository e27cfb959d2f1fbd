// SPDX-License-Identifier: Apache-2.0
#include "core/triangle_mesh.h"

#include <cstdint>
#include <utility>

#include "core/error.h"
#include "core/mesh_buffers.h"
#include "core/strided_buffer.h"

namespace kiwami {

namespace {

void check(const kiwami_triangle_mesh_desc& desc) {
  if (desc.flags & ~uint32_t{KIWAMI_MESH_SHARE_BUFFERS}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected KIWAMI_MESH_* bits",
                desc.flags);
  }
  if (desc.reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is %u, expected 0", desc.reserved);
  }
  check_fields(buffers_of(desc));
}

}  // namespace

TriangleMesh* TriangleMesh::create(Device& device, const kiwami_triangle_mesh_desc& desc) {
  check(desc);
  return make_object<TriangleMesh>(device.memory(), device, desc);
}

TriangleMesh::TriangleMesh(Device& device, const kiwami_triangle_mesh_desc& desc)
    : Geometry(device, GeometryKind::kTriangleMesh, desc.mask), view_(view_of(buffers_of(desc))) {
  shares_buffers_ = (desc.flags & KIWAMI_MESH_SHARE_BUFFERS) != 0;
  if (!shares_buffers_) copy_buffers();
  check_indices(view_, device);
}

TriangleMesh::TriangleMesh(Device& device, FileImage& image, const TriangleMeshView& view,
                           bool is_trusted)
    : Geometry(device, image, GeometryKind::kTriangleMesh, view.mask), view_(view) {
  vertices_ = Reference<BufferCopy>::adopt(BufferCopy::create(
      device, Array<unsigned char>::borrow(const_cast<unsigned char*>(view.vertices),
                                           view.vertex_count * kMeshElementSize)));
  if (view.indices) {
    indices_ = Array<unsigned char>::borrow(const_cast<unsigned char*>(view.indices),
                                            view.triangle_count * kMeshElementSize);
  }
  if (!is_trusted) check_indices(view_, device);
}

void TriangleMesh::copy_buffers() {
  vertices_ = Reference<BufferCopy>::adopt(
      BufferCopy::create(device(), packed_copy(view_.vertices, view_.vertex_stride,
                                               view_.vertex_count, kMeshElementSize, device())));
  view_.vertices = vertices_->bytes().data();
  view_.vertex_stride = kMeshElementSize;
  if (!view_.indices) return;
  indices_ = packed_copy(view_.indices, view_.index_stride, view_.triangle_count, kMeshElementSize,
                         device());
  // A mesh of no triangles keeps the caller's pointer, which is never read.
  if (view_.triangle_count != 0) view_.indices = indices_.data();
  view_.index_stride = kMeshElementSize;
}

size_t TriangleMesh::copied_bytes() const {
  size_t bytes = indices_.bytes();
  if (vertices_.get()) bytes += vertices_->bytes().bytes();
  if (spare_vertices_.get()) bytes += spare_vertices_->bytes().bytes();
  return bytes;
}

void TriangleMesh::update_vertices(const void* vertices, uint64_t offset, uint64_t stride) {
  check_stride("vertex_stride", stride, kMeshElementSize);
  const size_t step = stride != 0 ? static_cast<size_t>(stride) : kMeshElementSize;
  if (view_.vertex_count == 0) return;
  if (!vertices) {
    if (shares_buffers_) {
      has_changed();
      return;
    }
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "vertices is NULL for a mesh of %zu copied vertices, expected the vertices",
                view_.vertex_count);
  }
  check_extent("vertices", vertices, offset, step, view_.vertex_count, kMeshElementSize);
  const unsigned char* first = static_cast<const unsigned char*>(vertices) + offset;
  if (shares_buffers_) {
    view_.vertices = first;
    view_.vertex_stride = step;
    has_changed();
    return;
  }
  if (!spare_vertices_.get() || spare_vertices_->is_shared() ||
      !spare_vertices_->bytes().owns_memory()) {
    spare_vertices_ = Reference<BufferCopy>::adopt(BufferCopy::create(
        device(), Array<unsigned char>(device().memory(), view_.vertex_count * kMeshElementSize)));
  }
  pack(first, step, view_.vertex_count, kMeshElementSize, spare_vertices_->bytes().data(),
       device());
  std::swap(vertices_, spare_vertices_);
  view_.vertices = vertices_->bytes().data();
  view_.vertex_stride = kMeshElementSize;
  has_changed();
}

}  // namespace kiwami
