// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Sets a scene at rest in motion, from time 0 to time 1. `way` is
/// - meshes: a wave through space moves each vertex by up to a fiftieth of the scene's diagonal;
/// - instances: each is turned by up to a tenth of a turn and moved as far as that;
/// - else the path of another scene of the same meshes, whose vertices are those at time 1.
/// Throws SceneError where the scene has no instances, or the two do not have the same triangles.
void set_in_motion(SceneFile& scene, const std::string& way);

}  // namespace kiwami::tools
