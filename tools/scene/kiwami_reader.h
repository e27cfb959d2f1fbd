// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Whether the path names a file that the library saves.
bool is_saved_scene(const std::filesystem::path& path);

/// Reads the meshes of a scene that the library saved, by the layout that docs/files.md tells; mesh
/// i is geometry i, without triangles where there is none of that number. Checksums and the tree
/// are left to the library. Throws SceneError.
SceneFile read_saved_scene(const std::filesystem::path& path);

}  // namespace kiwami::tools
