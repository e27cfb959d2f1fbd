// SPDX-License-Identifier: Apache-2.0
// Small sets of lights that hold all that there can be.
#pragma once

#include <kiwami/kiwami.h>

namespace kiwami_tests {

struct RichLights {
  uint32_t width;
  uint32_t size;  ///< lights of a kind; 0: none at all
  bool has_instances;
};

/// Makes and commits it: lights of all types, triangles of a mesh without area or with a bad vertex,
/// distant lights, instances of two other sets, one of which is shown twice. On an error nothing is
/// left. *tree receives the handle, or NULL.
kiwami_result make_rich_lights(kiwami_device* device, const RichLights& what,
                               kiwami_light_tree** tree);

}  // namespace kiwami_tests
