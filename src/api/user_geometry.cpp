// SPDX-License-Identifier: Apache-2.0
#include "core/user_geometry.h"

#include "api/check.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;

kiwami_user_geometry_desc default_user_geometry() {
  kiwami_user_geometry_desc desc{};
  desc.mask = ~uint32_t{0};
  return desc;
}

}  // namespace

extern "C" {

kiwami_result kiwami_user_geometry_desc_init(kiwami_user_geometry_desc* desc, size_t size) {
  return guarded(nullptr, [&] {
    init_descriptor(desc, size, kMinimumDescSize, "desc", default_user_geometry());
  });
}

kiwami_result kiwami_user_geometry_create(kiwami_device* device,
                                          const kiwami_user_geometry_desc* desc,
                                          kiwami_geometry** geometry) {
  if (geometry) *geometry = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(geometry, "geometry");
    const kiwami_user_geometry_desc checked =
        read_descriptor(desc, kMinimumDescSize, "desc", default_user_geometry());
    *geometry = handle_of(UserGeometry::create(*object_of(device), checked));
  });
}

}  // extern "C"
