// SPDX-License-Identifier: Apache-2.0
#include "core/moving_mesh.h"

#include "api/check.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;

kiwami_moving_mesh_desc default_moving_mesh() {
  kiwami_moving_mesh_desc desc{};
  desc.step_count = 2;
  desc.time_end = 1.0f;
  desc.mask = ~uint32_t{0};
  return desc;
}

}  // namespace

extern "C" {

kiwami_result kiwami_moving_mesh_desc_init(kiwami_moving_mesh_desc* desc, size_t size) {
  return guarded(nullptr, [&] {
    init_descriptor(desc, size, kMinimumDescSize, "desc", default_moving_mesh());
  });
}

kiwami_result kiwami_moving_mesh_create(kiwami_device* device, const kiwami_moving_mesh_desc* desc,
                                        kiwami_geometry** geometry) {
  if (geometry) *geometry = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(geometry, "geometry");
    const kiwami_moving_mesh_desc checked =
        read_descriptor(desc, kMinimumDescSize, "desc", default_moving_mesh());
    *geometry = handle_of(MovingMesh::create(*object_of(device), checked));
  });
}

}  // extern "C"
