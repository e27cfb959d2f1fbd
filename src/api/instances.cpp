// SPDX-License-Identifier: Apache-2.0
#include "kiwami/instances.h"

#include "api/check.h"
#include "core/instances.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;

kiwami_instances_desc default_instances() {
  kiwami_instances_desc desc{};
  desc.mask = ~uint32_t{0};
  return desc;
}

}  // namespace

extern "C" {

kiwami_result kiwami_instances_desc_init(kiwami_instances_desc* desc, size_t size) {
  return guarded(
      nullptr, [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", default_instances()); });
}

kiwami_result kiwami_instances_create(kiwami_device* device, const kiwami_instances_desc* desc,
                                      kiwami_geometry** geometry) {
  if (geometry) *geometry = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(geometry, "geometry");
    const kiwami_instances_desc checked =
        read_descriptor(desc, kMinimumDescSize, "desc", default_instances());
    const DefaultFloatEnvironment environment;
    *geometry = handle_of(Instances::create(*object_of(device), checked));
  });
}

}  // extern "C"
