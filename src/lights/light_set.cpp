// SPDX-License-Identifier: Apache-2.0
#include "lights/light_set.h"

#include "lights/committed_lights.h"

namespace kiwami {

Reference<LightSet> LightSet::create(Device& device) {
  return Reference<LightSet>::adopt(make_object<LightSet>(device.memory(), device));
}

Reference<LightSet> LightSet::copy_of(const LightSet& other, size_t more_lights,
                                      size_t more_instances) {
  Reference<LightSet> copy = create(*other.device_);
  copy->lights.reserve(other.lights.size() + more_lights);
  copy->user_ids.reserve(other.lights.size() + more_lights);
  copy->instances.reserve(other.instances.size() + more_instances);
  for (size_t i = 0; i < other.lights.size(); ++i) {
    copy->lights.push_back(other.lights[i]);
    copy->user_ids.push_back(other.user_ids[i]);
  }
  for (size_t i = 0; i < other.instances.size(); ++i) {
    copy->instances.push_back(other.instances[i]).lights->retain();
  }
  return copy;
}

void LightSet::destroy(LightSet* set) noexcept {
  const Reference<Device> device = set->device_;
  destroy_object(device->memory(), set);
}

LightSet::LightSet(Device& device)
    : lights(device.memory()),
      user_ids(device.memory()),
      instances(device.memory()),
      device_(device) {}

LightSet::~LightSet() {
  for (size_t i = 0; i < instances.size(); ++i) instances[i].lights->release();
}

}  // namespace kiwami
