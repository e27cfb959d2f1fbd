// SPDX-License-Identifier: Apache-2.0
#include "core/triangle_mesh.h"

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <limits>

#include "core/error.h"
#include "core/strided_buffer.h"

namespace kiwami {

namespace {

/// Bytes of a vertex (three floats) and of a triangle (three indices).
constexpr size_t kElementSize = 12;
/// Triangles that one task checks.
constexpr size_t kBlockSize = 16384;

using ull = unsigned long long;

void check_counts(const kiwami_triangle_mesh_desc& desc) {
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

void check_fields(const kiwami_triangle_mesh_desc& desc) {
  if (desc.flags & ~uint32_t{KIWAMI_MESH_SHARE_BUFFERS}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected KIWAMI_MESH_* bits",
                desc.flags);
  }
  if (desc.reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is %u, expected 0", desc.reserved);
  }
  if (!desc.vertices && desc.vertex_count != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.vertices is NULL with desc.vertex_count %llu, expected the vertices",
                ull{desc.vertex_count});
  }
  check_stride("vertex_stride", desc.vertex_stride, kElementSize);
  check_stride("index_stride", desc.index_stride, kElementSize);
  check_counts(desc);
}

/// The buffers of a checked description.
TriangleMeshView view_of(const kiwami_triangle_mesh_desc& desc) {
  TriangleMeshView view{};
  view.vertex_stride = desc.vertex_stride ? static_cast<size_t>(desc.vertex_stride) : kElementSize;
  view.vertex_count = static_cast<size_t>(desc.vertex_count);
  view.index_stride = desc.index_stride ? static_cast<size_t>(desc.index_stride) : kElementSize;
  view.triangle_count = static_cast<uint32_t>(desc.triangle_count);
  check_extent("vertices", desc.vertices, desc.vertex_offset, view.vertex_stride, view.vertex_count,
               kElementSize);
  if (view.vertex_count != 0) {
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

/// Which of a triangle's three indices is at or beyond vertex_count; 3: none.
uint32_t invalid_corner(const uint32_t corner[3], size_t vertex_count) {
  uint32_t k = 0;
  while (k < 3 && corner[k] < vertex_count) ++k;
  return k;
}

}  // namespace

TriangleMesh* TriangleMesh::create(Device& device, const kiwami_triangle_mesh_desc& desc) {
  check_fields(desc);
  return make_object<TriangleMesh>(device.memory(), device, desc);
}

TriangleMesh::TriangleMesh(Device& device, const kiwami_triangle_mesh_desc& desc)
    : Geometry(device, GeometryKind::kTriangleMesh, desc.mask), view_(view_of(desc)) {
  shares_buffers_ = (desc.flags & KIWAMI_MESH_SHARE_BUFFERS) != 0;
  if (!shares_buffers_) copy_buffers();
  check_indices();
}

TriangleMesh::TriangleMesh(Device& device, FileImage& image, const TriangleMeshView& view,
                           bool is_trusted)
    : Geometry(device, GeometryKind::kTriangleMesh, view.mask), image_(image), view_(view) {
  vertices_ = Reference<BufferCopy>::adopt(BufferCopy::create(
      device, Array<unsigned char>::borrow(const_cast<unsigned char*>(view.vertices),
                                           view.vertex_count * kElementSize)));
  if (view.indices) {
    indices_ = Array<unsigned char>::borrow(const_cast<unsigned char*>(view.indices),
                                            view.triangle_count * kElementSize);
  }
  if (!is_trusted) check_indices();
}

void TriangleMesh::copy_buffers() {
  vertices_ = Reference<BufferCopy>::adopt(
      BufferCopy::create(device(), packed_copy(view_.vertices, view_.vertex_stride,
                                               view_.vertex_count, kElementSize, device())));
  view_.vertices = vertices_->bytes().data();
  view_.vertex_stride = kElementSize;
  if (!view_.indices) return;
  indices_ =
      packed_copy(view_.indices, view_.index_stride, view_.triangle_count, kElementSize, device());
  // A mesh of no triangles keeps the caller's pointer, which is never read.
  if (view_.triangle_count != 0) view_.indices = indices_.data();
  view_.index_stride = kElementSize;
}

size_t TriangleMesh::copied_bytes() const {
  size_t bytes = indices_.bytes();
  if (vertices_.get()) bytes += vertices_->bytes().bytes();
  if (spare_vertices_.get()) bytes += spare_vertices_->bytes().bytes();
  return bytes;
}

void TriangleMesh::update_vertices(const void* vertices, uint64_t offset, uint64_t stride) {
  check_stride("vertex_stride", stride, kElementSize);
  const size_t step = stride != 0 ? static_cast<size_t>(stride) : kElementSize;
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
  check_extent("vertices", vertices, offset, step, view_.vertex_count, kElementSize);
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
        device(), Array<unsigned char>(device().memory(), view_.vertex_count * kElementSize)));
  }
  pack(first, step, view_.vertex_count, kElementSize, spare_vertices_->bytes().data(), device());
  std::swap(vertices_, spare_vertices_);
  view_.vertices = vertices_->bytes().data();
  view_.vertex_stride = kElementSize;
  has_changed();
}

void TriangleMesh::check_indices() const {
  if (!view_.indices) return;
  // The lowest faulty triangle is reported, whichever thread finds one first.
  std::atomic<uint32_t> faulty{view_.triangle_count};
  device().parallel().for_blocks(view_.triangle_count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      uint32_t corner[3];
      view_.indices_of(static_cast<uint32_t>(i), corner);
      if (invalid_corner(corner, view_.vertex_count) == 3) continue;
      uint32_t lowest = faulty.load(std::memory_order_relaxed);
      while (i < lowest && !faulty.compare_exchange_weak(lowest, static_cast<uint32_t>(i))) {
      }
      return;
    }
  });
  const uint32_t triangle = faulty.load();
  if (triangle == view_.triangle_count) return;
  uint32_t corner[3];
  view_.indices_of(triangle, corner);
  const uint32_t k = invalid_corner(corner, view_.vertex_count);
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "index %u of triangle %u is %u, expected less than desc.vertex_count, which is %zu",
              k, triangle, corner[k % 3], view_.vertex_count);
}

}  // namespace kiwami
