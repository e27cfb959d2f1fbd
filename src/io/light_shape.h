// SPDX-License-Identifier: Apache-2.0
// The shape of a tree over lights in a file.
#pragma once

#include <span>

#include "lights/committed_lights.h"

namespace kiwami::file {

/// What LightShape names, over the memory of the file.
struct SavedLightShape {
  LightLinks links;
  WideLightTree tree;
  uint32_t leaf_count;
};

/// Checks that the links are a binary tree in depth-first order over just those lights and
/// instances of the set that belong into a tree, that the slots are clusters of it which divide
/// those above, and the depth that kernels rely on. Throws Error(INVALID_FILE).
SavedLightShape checked_light_shape(std::span<const uint32_t> links,
                                    std::span<const uint32_t> slots, uint32_t width,
                                    const LightSet& set, Memory& memory);

}  // namespace kiwami::file
