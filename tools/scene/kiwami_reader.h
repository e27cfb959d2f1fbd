// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Whether the path names a file that the library saves.
bool is_saved_scene(const std::filesystem::path& path);

/// Reads the meshes and instances of a scene that the library saved, by the layout that
/// docs/files.md tells. Of a scene without instances, mesh i is geometry i, without triangles where
/// there is none of that number; else each mesh of each scene is one of the file's, put into the
/// world through all instances that lead to it. Shapes and what moves are counted and left out,
/// with all that moving instances show. Checksums and trees are left to the library. Throws
/// SceneError.
SceneFile read_saved_scene(const std::filesystem::path& path);

}  // namespace kiwami::tools
