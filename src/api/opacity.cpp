// SPDX-License-Identifier: Apache-2.0
#include "kiwami/opacity.h"

#include "api/check.h"
#include "core/triangle_mesh.h"
#include "math/micro_triangle.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;

kiwami_opacity_desc no_opacity() {
  kiwami_opacity_desc desc{};
  desc.format = KIWAMI_OPACITY_2_STATES;
  return desc;
}

/// The caller's struct, its arrays checked, for a mesh of so many triangles.
kiwami_opacity_desc read_opacity(const kiwami_opacity_desc* given, uint32_t triangle_count) {
  const kiwami_opacity_desc desc = read_descriptor(given, kMinimumDescSize, "desc", no_opacity());
  check_reserved("desc.reserved", desc.reserved);
  if (desc.format != KIWAMI_OPACITY_2_STATES && desc.format != KIWAMI_OPACITY_4_STATES) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.format is %u, expected KIWAMI_OPACITY_2_STATES or KIWAMI_OPACITY_4_STATES",
                desc.format);
  }
  if (desc.level > KIWAMI_OPACITY_MAX_LEVEL) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.level is %u, expected at most %d", desc.level,
                KIWAMI_OPACITY_MAX_LEVEL);
  }
  const size_t bytes = std::max<size_t>(1, (size_t{desc.format} << (2 * desc.level)) / 8);
  if (desc.map_count != 0) {
    check_array("desc.maps", desc.maps, static_cast<size_t>(desc.map_stride), bytes,
                static_cast<size_t>(desc.map_count));
  }
  if (desc.indices && triangle_count != 0) {
    check_array("desc.indices", desc.indices, static_cast<size_t>(desc.index_stride),
                sizeof(uint32_t), triangle_count);
  }
  return desc;
}

}  // namespace

extern "C" {

kiwami_result kiwami_opacity_desc_init(kiwami_opacity_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", no_opacity()); });
}

kiwami_result kiwami_triangle_mesh_set_opacity(kiwami_geometry* mesh,
                                               const kiwami_opacity_desc* desc) {
  return guarded(mesh ? &object_of(mesh)->device() : nullptr, [&] {
    TriangleMesh& triangles = triangle_mesh_of(mesh, "mesh");
    if (!desc) {
      triangles.set_opacity({});
      return;
    }
    const kiwami_opacity_desc checked = read_opacity(desc, triangles.triangle_count());
    triangles.set_opacity(
        OpacityMap::create(triangles.device(), checked, triangles.triangle_count()));
  });
}

uint32_t kiwami_opacity_micro_triangle(float u, float v, uint32_t level) {
  return micro_triangle_at(u, v, std::min<uint32_t>(level, KIWAMI_OPACITY_MAX_LEVEL));
}

}  // extern "C"
