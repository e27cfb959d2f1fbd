// SPDX-License-Identifier: Apache-2.0
// Lights as they were described: what a tree is made of.
#pragma once

#include "core/device.h"
#include "core/memory.h"
#include "core/object.h"
#include "lights/light_record.h"

namespace kiwami {

class CommittedLights;

/// An instance as it was described. Who keeps one holds its lights.
struct LightInstance {
  CommittedLights* lights;
  float local_to_world[12];
  float power_scale;
  uint64_t link_mask;
};

/// Lights and instances by their numbers. A committed tree shares the set that it was made of with
/// the handle, which makes a copy before it changes what others hold.
class LightSet : public Object<LightSet> {
 public:
  /// Without lights. Throws Error(OUT_OF_MEMORY).
  static Reference<LightSet> create(Device& device);
  /// With room for so many lights and instances more.
  static Reference<LightSet> copy_of(const LightSet& other, size_t more_lights,
                                     size_t more_instances);
  static void destroy(LightSet* set) noexcept;

  explicit LightSet(Device& device);
  ~LightSet();

  uint64_t bytes() const {
    return sizeof(*this) + lights.size() * (sizeof(LightRecord) + sizeof(uint32_t)) +
           instances.size() * sizeof(LightInstance);
  }

  GrowingArray<LightRecord> lights;
  GrowingArray<uint32_t> user_ids;
  GrowingArray<LightInstance> instances;

 private:
  Reference<Device> device_;
};

}  // namespace kiwami
