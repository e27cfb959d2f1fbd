// SPDX-License-Identifier: Apache-2.0
#include "core/shapes.h"

#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/strided_buffer.h"

namespace kiwami {
namespace {

/// Bytes of a point (x, y, z, radius), a normal and an index.
constexpr size_t kPointSize = 16;
constexpr size_t kNormalSize = 12;
constexpr size_t kIndexSize = 4;

using ull = unsigned long long;

void check_header(uint32_t flags, uint32_t reserved) {
  if (flags & ~uint32_t{KIWAMI_SHAPES_SHARE_BUFFERS}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected KIWAMI_SHAPES_* bits",
                flags);
  }
  if (reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is %u, expected 0", reserved);
  }
}

void check_count(const char* name, uint64_t count, uint64_t limit) {
  if (count <= limit) return;
  throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.%s is %llu, expected at most %llu", name, ull{count},
              ull{limit});
}

constexpr uint64_t kMaxShapeCount = std::numeric_limits<int32_t>::max();
constexpr uint64_t kMaxPointCount = std::numeric_limits<uint32_t>::max();

/// Checks a buffer; sets where its first element is and the bytes from one to the next.
void read_buffer(const Shapes::Buffer& buffer, const unsigned char*& data, size_t& stride) {
  check_stride(buffer.stride_name, buffer.stride, buffer.element_size);
  stride = buffer.stride ? static_cast<size_t>(buffer.stride) : buffer.element_size;
  if (buffer.count == 0) return;
  if (!buffer.data) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.%s is NULL, expected %llu of them",
                buffer.name, ull{buffer.count});
  }
  check_extent(buffer.name, buffer.data, buffer.offset, stride, buffer.count, buffer.element_size);
  data = static_cast<const unsigned char*>(buffer.data) + buffer.offset;
}

}  // namespace

Shapes* Shapes::create(Device& device, const kiwami_spheres_desc& desc) {
  check_header(desc.flags, desc.reserved);
  check_count("sphere_count", desc.sphere_count, kMaxShapeCount);
  const Description description = {GeometryKind::kSpheres,
                                   desc.sphere_count,
                                   desc.flags,
                                   desc.mask,
                                   {"points", "point_stride", desc.points, desc.point_offset,
                                    desc.point_stride, desc.sphere_count, kPointSize},
                                   {},
                                   {}};
  return make_object<Shapes>(device.memory(), device, description);
}

Shapes* Shapes::create(Device& device, const kiwami_discs_desc& desc) {
  check_header(desc.flags, desc.reserved);
  check_count("disc_count", desc.disc_count, kMaxShapeCount);
  const Description description = {GeometryKind::kDiscs,
                                   desc.disc_count,
                                   desc.flags,
                                   desc.mask,
                                   {"points", "point_stride", desc.points, desc.point_offset,
                                    desc.point_stride, desc.disc_count, kPointSize},
                                   {"normals", "normal_stride", desc.normals, desc.normal_offset,
                                    desc.normal_stride, desc.disc_count, kNormalSize},
                                   {}};
  return make_object<Shapes>(device.memory(), device, description);
}

Shapes* Shapes::create(Device& device, const kiwami_curves_desc& desc) {
  check_header(desc.flags, desc.reserved);
  check_count("point_count", desc.point_count, kMaxPointCount);
  check_count("segment_count", desc.segment_count, kMaxShapeCount);
  if (!desc.indices && desc.segment_count != 0 && desc.segment_count >= desc.point_count) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.segment_count is %llu with desc.indices NULL, expected less than "
                "desc.point_count, which is %llu",
                ull{desc.segment_count}, ull{desc.point_count});
  }
  const Description description = {
      GeometryKind::kCurves,
      desc.segment_count,
      desc.flags,
      desc.mask,
      {"points", "point_stride", desc.points, desc.point_offset, desc.point_stride,
       desc.point_count, kPointSize},
      {},
      {"indices", "index_stride", desc.indices, desc.index_offset, desc.index_stride,
       desc.indices ? desc.segment_count : 0, kIndexSize}};
  return make_object<Shapes>(device.memory(), device, description);
}

Shapes::Shapes(Device& device, const Description& description)
    : Geometry(device, description.kind, description.mask) {
  view_.count = static_cast<uint32_t>(description.count);
  view_.point_count = static_cast<size_t>(description.points.count);
  read_buffer(description.points, view_.points, view_.point_stride);
  read_buffer(description.normals, view_.normals, view_.normal_stride);
  read_buffer(description.indices, view_.indices, view_.index_stride);
  if ((description.flags & KIWAMI_SHAPES_SHARE_BUFFERS) == 0) copy_buffers();
  check_indices();
}

Shapes::Shapes(Device& device, FileImage& image, GeometryKind kind, const ShapeView& view,
               bool is_trusted)
    : Geometry(device, image, kind, view.mask), view_(view) {
  const auto borrow = [](const unsigned char* data, size_t count, size_t size) {
    return Array<unsigned char>::borrow(const_cast<unsigned char*>(data), data ? count * size : 0);
  };
  points_ = borrow(view.points, view.point_count, kPointSize);
  normals_ = borrow(view.normals, view.count, kNormalSize);
  indices_ = borrow(view.indices, view.count, kIndexSize);
  if (!is_trusted) check_indices();
}

void Shapes::copy_buffers() {
  const auto copy = [&](Array<unsigned char>& own, const unsigned char*& data, size_t& stride,
                        size_t count, size_t size) {
    if (!data) return;
    own = packed_copy(data, stride, count, size, device());
    data = own.data();
    stride = size;
  };
  copy(points_, view_.points, view_.point_stride, view_.point_count, kPointSize);
  copy(normals_, view_.normals, view_.normal_stride, view_.count, kNormalSize);
  copy(indices_, view_.indices, view_.index_stride, view_.count, kIndexSize);
}

void Shapes::check_indices() const {
  if (!view_.indices) return;
  for (uint32_t i = 0; i < view_.count; ++i) {
    uint32_t index;
    std::memcpy(&index, view_.indices + i * view_.index_stride, sizeof index);
    if (size_t{index} + 1 < view_.point_count) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "index %u is %u, expected less than desc.point_count - 1 with desc.point_count %zu",
                i, index, view_.point_count);
  }
}

}  // namespace kiwami
