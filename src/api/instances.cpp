// SPDX-License-Identifier: Apache-2.0
#include "kiwami/moving_instances.h"

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

kiwami_moving_instances_desc default_moving_instances() {
  kiwami_moving_instances_desc desc{};
  desc.format = KIWAMI_TRANSFORM_MATRIX;
  desc.step_count = 2;
  desc.time_end = 1.0f;
  desc.mask = ~uint32_t{0};
  return desc;
}

/// The instances behind a handle; throws Error for one that is NULL or another kind of geometry.
const Instances& instances_of(const kiwami_geometry* handle, const char* name) {
  check_not_null(handle, name);
  const Geometry& geometry = *object_of(const_cast<kiwami_geometry*>(handle));
  if (geometry.kind() != GeometryKind::kInstances) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "%s is a geometry of another kind, expected instances", name);
  }
  return static_cast<const Instances&>(geometry);
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

kiwami_result kiwami_moving_instances_desc_init(kiwami_moving_instances_desc* desc, size_t size) {
  return guarded(nullptr, [&] {
    init_descriptor(desc, size, kMinimumDescSize, "desc", default_moving_instances());
  });
}

kiwami_result kiwami_moving_instances_create(kiwami_device* device,
                                             const kiwami_moving_instances_desc* desc,
                                             kiwami_geometry** geometry) {
  if (geometry) *geometry = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(geometry, "geometry");
    const kiwami_moving_instances_desc checked =
        read_descriptor(desc, kMinimumDescSize, "desc", default_moving_instances());
    const DefaultFloatEnvironment environment;
    *geometry = handle_of(Instances::create(*object_of(device), checked));
  });
}

kiwami_result kiwami_instances_transform(const kiwami_geometry* instances, uint64_t instance,
                                         float time, float* transform) {
  return guarded(device_of(const_cast<kiwami_geometry*>(instances)), [&] {
    const Instances& array = instances_of(instances, "instances");
    check_not_null(transform, "transform");
    const DefaultFloatEnvironment environment;
    float rows[12];
    array.read_transform(instance, time, rows);
    std::memcpy(transform, rows, sizeof rows);
  });
}

}  // extern "C"
