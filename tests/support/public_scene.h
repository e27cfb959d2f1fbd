// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "support/mesh.h"

namespace kiwami_tests {

/// A public scene with its instances flattened: mesh i is geometry i. Throws what the reader
/// throws.
Scene load_public_scene(const std::filesystem::path& path);

/// The name of a scene file as part of a test's name; "none" for an empty path.
std::string test_name_of(const std::filesystem::path& path);

/// public_scenes(), or one empty path where there are none: parametrised tests skip that one.
std::vector<std::filesystem::path> public_scenes_or_none();

}  // namespace kiwami_tests
