// SPDX-License-Identifier: Apache-2.0
// What a run of the tests can be told by environment variables.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace kiwami_tests {

/// KIWAMI_SEED, or a fixed number. Random tests print it.
uint64_t seed();

/// How many rays (or cases) a test takes: KIWAMI_TEST_RAYS where it is set (the long form), else
/// short_form * KIWAMI_TEST_SCALE (1 where it is not set), at least 1.
uint64_t ray_budget(uint64_t short_form);

/// Cases that cost more than a ray (scenes, builds): short_form * min(1, KIWAMI_TEST_SCALE).
uint64_t case_budget(uint64_t short_form);

/// The public scenes of KIWAMI_SCENES or of the folder shared/scenes beside the project, by name;
/// empty where there is no such folder.
std::vector<std::filesystem::path> public_scenes();

/// Larger public scenes are left out of the short form: 100,000 triangles, or
/// KIWAMI_TEST_SCENE_TRIANGLES.
uint64_t public_scene_limit();

}  // namespace kiwami_tests
