// SPDX-License-Identifier: Apache-2.0
#include "kiwami/shapes.h"

#include "api/check.h"
#include "core/shapes.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;

template <typename Desc>
Desc default_desc() {
  Desc desc{};
  desc.mask = ~uint32_t{0};
  return desc;
}

template <typename Desc>
kiwami_result init_shapes(Desc* desc, size_t size) {
  return guarded(nullptr, [&] {
    init_descriptor(desc, size, kMinimumDescSize, "desc", default_desc<Desc>());
  });
}

template <typename Desc>
kiwami_result create_shapes(kiwami_device* device, const Desc* desc, kiwami_geometry** geometry) {
  if (geometry) *geometry = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(geometry, "geometry");
    const Desc checked = read_descriptor(desc, kMinimumDescSize, "desc", default_desc<Desc>());
    *geometry = handle_of(Shapes::create(*object_of(device), checked));
  });
}

}  // namespace

extern "C" {

kiwami_result kiwami_spheres_desc_init(kiwami_spheres_desc* desc, size_t size) {
  return init_shapes(desc, size);
}
kiwami_result kiwami_discs_desc_init(kiwami_discs_desc* desc, size_t size) {
  return init_shapes(desc, size);
}
kiwami_result kiwami_curves_desc_init(kiwami_curves_desc* desc, size_t size) {
  return init_shapes(desc, size);
}

kiwami_result kiwami_spheres_create(kiwami_device* device, const kiwami_spheres_desc* desc,
                                    kiwami_geometry** geometry) {
  return create_shapes(device, desc, geometry);
}
kiwami_result kiwami_discs_create(kiwami_device* device, const kiwami_discs_desc* desc,
                                  kiwami_geometry** geometry) {
  return create_shapes(device, desc, geometry);
}
kiwami_result kiwami_curves_create(kiwami_device* device, const kiwami_curves_desc* desc,
                                   kiwami_geometry** geometry) {
  return create_shapes(device, desc, geometry);
}

}  // extern "C"
