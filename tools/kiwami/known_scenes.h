// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// load_scene, flattened; a public scene that is known by its file name gets a camera that shows it
/// well (benchmarks/scenes.json).
SceneFile load_known_scene(const std::filesystem::path& path);

/// The names of the lists of benchmark scenes: "tuning" and "judging".
std::vector<std::string> scene_list_names();

/// The scenes of a list, those that are files being in `folder`. Throws SceneError for a list that
/// there is not.
std::vector<std::string> scenes_of_list(const std::string& list,
                                        const std::filesystem::path& folder);

}  // namespace kiwami::tools
