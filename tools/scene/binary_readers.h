// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Reads a .tri file, little endian: char[4] 'TRI1', u32 vertex_count, u32 triangle_count,
/// f32 xyz[vertex_count], u32 abc[triangle_count]. Throws SceneError.
SceneFile read_tri(const std::filesystem::path& path);

/// Reads an .ins file, little endian: char[4] 'INS1', u32 mesh_count, u32 instance_count; per mesh
/// as a .tri file without its first four bytes; per instance u32 mesh, f32[12] object-to-world, 3x4
/// row major. Throws SceneError.
SceneFile read_ins(const std::filesystem::path& path);

}  // namespace kiwami::tools
