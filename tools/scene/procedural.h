// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// The scene of a name such as "stadium", "sphere:5", "terrain:200", "soup:1000:7" or "room";
/// nothing when `name` is not a procedural scene's. Throws SceneError for a number outside its
/// bounds.
std::optional<SceneFile> make_procedural_scene(const std::string& name);

/// What make_procedural_scene understands, for messages and help.
std::string procedural_scene_names();

/// A closed sphere of radius 1: an icosahedron divided `level` times, 20 * 4^level triangles.
Mesh make_sphere(uint32_t level);

/// A height field over a square of 2 by 2: 2 * cells * cells triangles.
Mesh make_terrain(uint32_t cells);

/// Random triangles in a cube of 2 by 2 by 2, their sizes spread over three decades.
Mesh make_soup(uint32_t triangle_count, uint64_t seed);

}  // namespace kiwami::tools
