// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// A ball of curved ribbons that grow from its middle: long thin triangles that overlap in every
/// box. Exactly `triangle_count` triangles.
SceneFile make_hairball(uint64_t triangle_count);

/// A closed room with hundreds of rotated copies of several meshes in it, as instances; at least
/// `triangle_count` triangles in the world.
SceneFile make_room(uint64_t triangle_count);

}  // namespace kiwami::tools
