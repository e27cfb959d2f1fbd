// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// A forest on a hilly floor: `tree_count` instances of a few trees with crowns of leaf cards, so
/// close to each other that the crowns overlap, turned and scaled at random.
SceneFile make_forest(uint64_t tree_count);

}  // namespace kiwami::tools
