// SPDX-License-Identifier: Apache-2.0
#include "kiwami/geometry.h"

#include "api/check.h"
#include "core/triangle_mesh.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;

kiwami_triangle_mesh_desc default_mesh() {
  kiwami_triangle_mesh_desc desc{};
  desc.mask = ~uint32_t{0};
  return desc;
}

}  // namespace

extern "C" {

kiwami_result kiwami_triangle_mesh_desc_init(kiwami_triangle_mesh_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", default_mesh()); });
}

kiwami_result kiwami_triangle_mesh_create(kiwami_device* device,
                                          const kiwami_triangle_mesh_desc* desc,
                                          kiwami_geometry** geometry) {
  if (geometry) *geometry = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(geometry, "geometry");
    const kiwami_triangle_mesh_desc checked =
        read_descriptor(desc, kMinimumDescSize, "desc", default_mesh());
    *geometry = handle_of(TriangleMesh::create(*object_of(device), checked));
  });
}

kiwami_result kiwami_triangle_mesh_update_vertices(kiwami_geometry* geometry, const void* vertices,
                                                   uint64_t vertex_offset, uint64_t vertex_stride) {
  return guarded(device_of(geometry), [&] {
    check_not_null(geometry, "geometry");
    if (object_of(geometry)->kind() != GeometryKind::kTriangleMesh) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "geometry is none, expected a triangle mesh");
    }
    static_cast<TriangleMesh*>(object_of(geometry))
        ->update_vertices(vertices, vertex_offset, vertex_stride);
  });
}

kiwami_result kiwami_geometry_set_mask(kiwami_geometry* geometry, uint32_t mask) {
  return guarded(device_of(geometry), [&] {
    check_not_null(geometry, "geometry");
    object_of(geometry)->set_mask(mask);
  });
}

void kiwami_geometry_retain(kiwami_geometry* geometry) {
  if (geometry) object_of(geometry)->retain();
}

void kiwami_geometry_release(kiwami_geometry* geometry) {
  if (geometry) object_of(geometry)->release();
}

}  // extern "C"
