// SPDX-License-Identifier: Apache-2.0
#include "support/report.h"

#include <cstdio>

namespace kiwami_tests {

std::string describe(const kiwami_ray& ray) {
  char text[512];
  std::snprintf(text, sizeof text,
                "origin (%a, %a, %a) direction (%a, %a, %a) tmin %a tmax %a mask %#x flags %u",
                ray.origin_x, ray.origin_y, ray.origin_z, ray.direction_x, ray.direction_y,
                ray.direction_z, ray.tmin, ray.tmax, ray.mask, ray.flags);
  return text;
}

std::string describe(const kiwami_hit& hit) {
  char text[512];
  std::snprintf(text, sizeof text,
                "t %a u %a v %a normal (%a, %a, %a) primitive %u geometry %u instance %u", hit.t,
                hit.u, hit.v, hit.normal_x, hit.normal_y, hit.normal_z, hit.primitive_id,
                hit.geometry_id, hit.instance_id);
  return text;
}

}  // namespace kiwami_tests
