// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "scene/scene_file.h"

namespace kiwami::tools {

/// The 'teapot in a stadium': a dense teapot, 4 units across, on the floor of a coarse stadium 300
/// units long. Triangle areas span many decades, which is what naive hierarchies stumble over.
SceneFile make_teapot_stadium();

}  // namespace kiwami::tools
