// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// load_scene, flattened unless its instances are kept; a public scene that is known by its file
/// name gets a camera that shows it well (benchmarks/scenes.json).
SceneFile load_known_scene(const std::filesystem::path& path, bool keep_instances = false,
                           OtherGeometries others = OtherGeometries::kRefused);

/// The names of the lists of benchmark scenes: automatic choices are tuned on "tuning" alone, and
/// figures are reported for "judging" alone.
std::vector<std::string> scene_list_names();

/// The scenes of a list, those that are files being in `folder`. `list` is one of
/// scene_list_names, or a text file with a scene a line (# begins a comment). Throws SceneError
/// when it is neither, or an empty file.
std::vector<std::string> scenes_of_list(const std::string& list,
                                        const std::filesystem::path& folder);

}  // namespace kiwami::tools
