// SPDX-License-Identifier: Apache-2.0
#include "kiwami/device.h"

#include "api/check.h"
#include "dispatch/dispatch.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 16;
constexpr size_t kMinimumInfoSize = 8;

// Every default of a device is zero.
constexpr kiwami_device_desc kDefaults{};

}  // namespace

extern "C" {

kiwami_result kiwami_device_desc_init(kiwami_device_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", kDefaults); });
}

kiwami_result kiwami_device_create(const kiwami_device_desc* desc, kiwami_device** device) {
  if (device) *device = nullptr;
  return guarded(nullptr, [&] {
    check_not_null(device, "device");
    const kiwami_device_desc checked =
        desc ? read_descriptor(desc, kMinimumDescSize, "desc", kDefaults) : kDefaults;
    *device = reinterpret_cast<kiwami_device*>(Device::create(checked));
  });
}

void kiwami_device_retain(kiwami_device* device) {
  if (device) object_of(device)->retain();
}

void kiwami_device_release(kiwami_device* device) {
  if (device) object_of(device)->release();
}

kiwami_result kiwami_device_get_info(const kiwami_device* device, kiwami_device_info* info) {
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    write_info(info, kMinimumInfoSize, "info", object_of(device)->info());
  });
}

const char* kiwami_isa_name(uint32_t isa) {
  const char* name = isa_name(isa);
  return name ? name : "unknown";
}

}  // extern "C"
