// SPDX-License-Identifier: Apache-2.0
#include "core/geometry.h"

namespace kiwami {

void Geometry::destroy(Geometry* geometry) noexcept {
  const Reference<Device> device = geometry->device_;
  geometry->end(device->memory());
}

}  // namespace kiwami
