// SPDX-License-Identifier: Apache-2.0
#include "kiwami/tetrahedra.h"

#include "api/check.h"
#include "tetrahedra/tetrahedron_mesh.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumStructSize = 8;
constexpr size_t kPointSize = 3 * sizeof(float);
constexpr size_t kIndexSize = 4 * sizeof(uint32_t);
constexpr kiwami_tetrahedra_desc kNoTetrahedra{};

TetrahedronMesh* object_of(kiwami_tetrahedra* handle) {
  return reinterpret_cast<TetrahedronMesh*>(handle);
}
const TetrahedronMesh* object_of(const kiwami_tetrahedra* handle) {
  return reinterpret_cast<const TetrahedronMesh*>(handle);
}
const Device* device_of(const kiwami_tetrahedra* tetrahedra) {
  return tetrahedra ? &object_of(tetrahedra)->device() : nullptr;
}

size_t stride_or(uint64_t stride, size_t size) {
  return stride ? static_cast<size_t>(stride) : size;
}

void check_count(const char* name, uint64_t count, uint64_t limit) {
  if (count <= limit) return;
  throw Error(KIWAMI_ERROR_TOO_LARGE, "%s is %llu, expected at most %llu", name,
              static_cast<unsigned long long>(count), static_cast<unsigned long long>(limit));
}

TetrahedronInput read_desc(const kiwami_tetrahedra_desc* given) {
  const kiwami_tetrahedra_desc desc =
      read_descriptor(given, kMinimumStructSize, "desc", kNoTetrahedra);
  if (desc.method > KIWAMI_TETRAHEDRA_FACES) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.method is %u, expected one of KIWAMI_TETRAHEDRA_*", desc.method);
  }
  check_count("desc.vertex_count", desc.vertex_count, TetrahedronMesh::kMaxVertexCount);
  check_count("desc.tetrahedron_count", desc.tetrahedron_count,
              TetrahedronMesh::kMaxTetrahedronCount);
  if (desc.vertex_count != 0) {
    check_array("desc.vertices", desc.vertices, static_cast<size_t>(desc.vertex_stride), kPointSize,
                static_cast<size_t>(desc.vertex_count));
  }
  if (desc.tetrahedron_count != 0) {
    check_array("desc.indices", desc.indices, static_cast<size_t>(desc.index_stride), kIndexSize,
                static_cast<size_t>(desc.tetrahedron_count));
  }
  return {desc.method,
          static_cast<const unsigned char*>(desc.vertices),
          stride_or(desc.vertex_stride, kPointSize),
          static_cast<size_t>(desc.vertex_count),
          static_cast<const unsigned char*>(desc.indices),
          stride_or(desc.index_stride, kIndexSize),
          static_cast<size_t>(desc.tetrahedron_count)};
}

}  // namespace

extern "C" {

kiwami_result kiwami_tetrahedra_desc_init(kiwami_tetrahedra_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumStructSize, "desc", kNoTetrahedra); });
}

kiwami_result kiwami_tetrahedra_create(kiwami_device* device, const kiwami_tetrahedra_desc* desc,
                                       kiwami_tetrahedra** tetrahedra) {
  if (tetrahedra) *tetrahedra = nullptr;
  return guarded(device ? kiwami::api::object_of(device) : nullptr, [&] {
    check_not_null(device, "device");
    check_not_null(tetrahedra, "tetrahedra");
    TetrahedronMesh* const made =
        TetrahedronMesh::create(*kiwami::api::object_of(device), read_desc(desc));
    *tetrahedra = reinterpret_cast<kiwami_tetrahedra*>(made);
  });
}

void kiwami_tetrahedra_retain(kiwami_tetrahedra* tetrahedra) {
  if (tetrahedra) object_of(tetrahedra)->retain();
}

void kiwami_tetrahedra_release(kiwami_tetrahedra* tetrahedra) {
  if (tetrahedra) object_of(tetrahedra)->release();
}

kiwami_result kiwami_tetrahedra_get_info(const kiwami_tetrahedra* tetrahedra,
                                         kiwami_tetrahedra_info* info) {
  return guarded(device_of(tetrahedra), [&] {
    check_not_null(tetrahedra, "tetrahedra");
    check_not_null(info, "info");
    write_info(info, kMinimumStructSize, "info", object_of(tetrahedra)->info());
  });
}

kiwami_result kiwami_tetrahedra_locate(const kiwami_tetrahedra* tetrahedra, const void* points,
                                       size_t point_stride, kiwami_tetrahedron_location* locations,
                                       size_t location_stride, size_t count) {
  return guarded(device_of(tetrahedra), [&] {
    check_not_null(tetrahedra, "tetrahedra");
    if (count == 0) return;
    const TetrahedronMesh& object = *object_of(tetrahedra);
    if (object.device().validates_arguments()) {
      check_array("points", points, point_stride, kPointSize, count);
      check_array("locations", locations, location_stride, sizeof(kiwami_tetrahedron_location),
                  count);
    }
    object.locate({static_cast<const unsigned char*>(points), stride_or(point_stride, kPointSize),
                   reinterpret_cast<unsigned char*>(locations),
                   stride_or(location_stride, sizeof(kiwami_tetrahedron_location)), count});
  });
}

}  // extern "C"
