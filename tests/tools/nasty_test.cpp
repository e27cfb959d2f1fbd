// SPDX-License-Identifier: Apache-2.0
// Malformed files of other projects' test suites: a picture or a sentence, never a crash.
#include <gtest/gtest.h>

#include <filesystem>

#include "run_command.h"

namespace kiwami_tests {
namespace {

void expect_picture_or_sentence(const TemporaryFolder& folder, const std::string& scene) {
  const CommandResult result =
      run_command({"render", scene, "-o", folder / "a.ppm", "--size", "24x18", "--spp", "1"});
  if (result.exit_code == 0) {
    EXPECT_EQ(result.errors, "") << scene;
  } else {
    EXPECT_EQ(complaint_about_failure(result), "") << scene;
  }
}

TEST(NastyFiles, GiveAPictureOrASentence) {
  const std::string nasty = shared_scene("nasty");
  if (nasty.empty()) GTEST_SKIP() << "the shared scenes are absent";
  const TemporaryFolder folder;
  for (const auto& entry : std::filesystem::directory_iterator(nasty)) {
    expect_picture_or_sentence(folder, entry.path().string());
  }
}

TEST(NastyFiles, CutInTheMiddleGiveAPictureOrASentence) {
  const std::string nasty = shared_scene("nasty");
  if (nasty.empty()) GTEST_SKIP() << "the shared scenes are absent";
  const TemporaryFolder folder;
  for (const auto& entry : std::filesystem::directory_iterator(nasty)) {
    const std::string bytes = read_bytes(entry.path().string());
    const std::string name = entry.path().filename().string();
    expect_picture_or_sentence(folder, folder.write(name, bytes.substr(0, bytes.size() / 2)));
  }
}

TEST(SharedScenes, ObjAndTriOfTheSameSceneHaveAsManyTriangles) {
  const std::string obj = shared_scene("sponza.obj.gz");
  const std::string tri = shared_scene("sponza.tri.gz");
  if (obj.empty() || tri.empty()) GTEST_SKIP() << "the shared scenes are absent";
  const TemporaryFolder folder;
  for (const std::string& scene : {obj, tri}) {
    const CommandResult result =
        run_command({"render", scene, "-o", folder / "a.png", "--size", "32x24", "--spp", "1"});
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("66,450 triangles"), std::string::npos) << result.output;
  }
}

TEST(SharedScenes, AreVerified) {
  for (const char* name : {"cornell_original.tri.gz", "cornell_sphere.tri.gz", "holodeck.tri.gz",
                           "scrub_pine.tri.gz", "ifc_fzk_haus.tri.gz", "truck_town.ins.gz"}) {
    const std::string scene = shared_scene(name);
    if (scene.empty()) GTEST_SKIP() << "the shared scenes are absent";
    const CommandResult result = run_command({"verify", scene, "--rays", "1000"});
    EXPECT_EQ(result.exit_code, 0) << name << "\n" << result.output << result.errors;
  }
}

}  // namespace
}  // namespace kiwami_tests
