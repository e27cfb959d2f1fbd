// SPDX-License-Identifier: Apache-2.0
// Files of programs on the command line: with shapes, motion, and instances of all kinds.
#include <gtest/gtest.h>
#include <kiwami/kiwami.h>

#include "run_command.h"
#include "support/library.h"
#include "support/rich_scene.h"

namespace kiwami_tests {
namespace {

void save(const std::string& path, uint32_t parts) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  kiwami_scene* made = nullptr;
  ASSERT_EQ(make_rich_scene(device.get(), {parts, 4, 40}, &made), KIWAMI_OK);
  const SceneHandle scene(made);
  kiwami_save_desc desc;
  ASSERT_EQ(kiwami_save_desc_init(&desc, sizeof desc), KIWAMI_OK);
  desc.path = path.c_str();
  ASSERT_EQ(kiwami_scene_save(made, &desc, nullptr), KIWAMI_OK);
}

TEST(RichFiles, AreTakenByTheCommandsThatCanUseThem) {
  const TemporaryFolder folder;
  const std::string path = folder / "scene.kiwami";
  for (const uint32_t parts : {uint32_t{kRichShapes}, uint32_t{kRichMotion},
                               kRichInstances | kRichMovingInstances, uint32_t{kRichAll}}) {
    SCOPED_TRACE(parts);
    save(path, parts);
    const std::vector<std::string> commands[] = {
        {"info", path},
        {"verify", path, "--rays", "100"},
        {"inspect", path, "--json", folder / "tree.json", "--ray-count", "64"},
        {"render", path, "-o", folder / "a.ppm", "--size", "24x24", "--spp", "2"}};
    for (const std::vector<std::string>& command : commands) {
      const CommandResult result = run_command(command);
      EXPECT_EQ(result.exit_code, 0) << command[0] << ": " << result.errors;
      if (command[0] == "info") continue;
      EXPECT_NE(result.output.find("that are shapes or move"), std::string::npos) << result.output;
    }
  }
}

TEST(RichFiles, ShowTheirMotion) {
  const TemporaryFolder folder;
  const std::string path = folder / "scene.kiwami";
  save(path, kRichMotion | kRichMovingInstances);
  std::string pictures[3];
  const char* const shutters[] = {"0,0", "0.5,0.5", "0,1"};
  for (int i = 0; i < 3; ++i) {
    const std::string picture = folder / "x.ppm";
    const CommandResult result =
        run_command({"render", path, "-o", picture, "--size", "32x32", "--spp", "1", "--mode",
                     "normals", "--shutter", shutters[i]});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    pictures[i] = read_bytes(picture);
  }
  EXPECT_NE(pictures[0], pictures[1]);
  EXPECT_NE(pictures[1], pictures[2]);
  EXPECT_NE(pictures[0], pictures[2]);
}

TEST(RichFiles, AreRefusedByWhatGoesByTriangles) {
  const TemporaryFolder folder;
  const std::string path = folder / "scene.kiwami", picture = folder / "x.ppm";
  save(path, kRichShapes);
  const std::vector<std::string> commands[] = {
      {"bench", path, "--rays", "random", "--ray-count", "64", "--rounds", "1"},
      {"build", path, "-o", folder / "again.kiwami"},
      {"demo", path, "-o", picture},
      {"render", path, "-o", picture, "--motion", "meshes"},
      {"render", path, "-o", picture, "--leaf-mask", "2"},
      {"render", path, "-o", picture, "--lights", "tree"}};
  for (const std::vector<std::string>& command : commands) {
    const CommandResult result = run_command(command);
    EXPECT_EQ(complaint_about_failure(result), "") << command[0];
    EXPECT_NE(result.errors.find("holds 4 geometries that are shapes or move"), std::string::npos)
        << result.errors;
  }
}

}  // namespace
}  // namespace kiwami_tests
