// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Reads a Wavefront OBJ file: each object or group becomes a mesh, polygons are triangulated,
/// materials, normals and texture coordinates are dropped. Throws SceneError.
SceneFile read_obj(const std::filesystem::path& path);

}  // namespace kiwami::tools
