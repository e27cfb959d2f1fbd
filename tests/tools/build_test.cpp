// SPDX-License-Identifier: Apache-2.0
// `kiwami build` saves scenes, and every other command takes what it saved.
#include <gtest/gtest.h>

#include "run_command.h"

namespace kiwami_tests {
namespace {

std::string build(const TemporaryFolder& folder, const std::vector<std::string>& options) {
  const std::string path = folder / "scene.kiwami";
  std::vector<std::string> arguments = {"build", "sphere:3", "-o", path};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const CommandResult result = run_command(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("wrote   " + path), std::string::npos) << result.output;
  return path;
}

TEST(Build, SaysHowLongLoadsTake) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_command({"build", "sphere:2", "-o", folder / "s.kiwami", "--time-loads", "3"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const char* way : {"copied, checked", "mapped, checked", "mapped, trusted"}) {
    EXPECT_NE(result.output.find(std::string("load    ") + way), std::string::npos) << way;
  }
}

TEST(Build, ItsFileRendersTheSamePicture) {
  const TemporaryFolder folder;
  const std::string path = build(folder, {"--bvh-width", "4"});
  const std::string pictures[] = {folder / "a.ppm", folder / "b.ppm"};
  const std::string scenes[] = {"sphere:3", path};
  for (int i = 0; i < 2; ++i) {
    const CommandResult result = run_command({"render", scenes[i], "-o", pictures[i], "--size",
                                              "41x37", "--spp", "1", "--eye", "0,0,4"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
  }
  EXPECT_EQ(read_bytes(pictures[0]), read_bytes(pictures[1]));
}

TEST(Build, ItsFileIsTakenByEveryCommand) {
  const TemporaryFolder folder;
  const std::string path = build(folder, {});
  const std::vector<std::string> commands[] = {
      {"info", path},
      {"verify", path, "--rays", "200"},
      {"bench", path, "--rays", "random", "--ray-count", "1024", "--rounds", "1"},
      {"inspect", path, "--json", folder / "tree.json", "--ray-count", "64"},
      {"build", path, "-o", folder / "again.kiwami"}};
  for (const std::vector<std::string>& command : commands) {
    const CommandResult result = run_command(command);
    EXPECT_EQ(result.exit_code, 0) << command[0] << ": " << result.errors;
  }
  const CommandResult info = run_command({"info", path, "--json"});
  EXPECT_NE(info.output.find("\"kind\": \"scene\""), std::string::npos) << info.output;
  EXPECT_NE(info.output.find("\"triangles\": 1280"), std::string::npos) << info.output;
}

TEST(Build, KeepsInstancesIfItIsTold) {
  const TemporaryFolder folder;
  const std::string kept = folder / "kept.kiwami", flat = folder / "flat.kiwami";
  const CommandResult built = run_command({"build", "forest:12", "-o", kept, "--instanced"});
  ASSERT_EQ(built.exit_code, 0) << built.errors;
  ASSERT_EQ(run_command({"build", "forest:12", "-o", flat}).exit_code, 0);
  EXPECT_LT(2 * read_bytes(kept).size(), read_bytes(flat).size());
  const std::vector<std::string> commands[] = {
      {"info", kept},
      {"verify", kept, "--rays", "100"},
      {"verify", kept, "--rays", "100", "--instanced"},
      {"bench", kept, "--rays", "random", "--ray-count", "512", "--rounds", "1"},
      {"inspect", kept, "--json", folder / "tree.json", "--ray-count", "64"},
      {"build", kept, "-o", folder / "again.kiwami", "--instanced", "--time-loads", "1"}};
  for (const std::vector<std::string>& command : commands) {
    const CommandResult result = run_command(command);
    EXPECT_EQ(result.exit_code, 0) << command[0] << ": " << result.errors;
  }
  // The same picture from the scene, from the file, and from the file that was made of the file.
  std::string pictures[3];
  const std::string scenes[] = {"forest:12", kept, folder / "again.kiwami"};
  for (int i = 0; i < 3; ++i) {
    const std::string picture = folder / "x.ppm";
    const CommandResult result =
        run_command({"render", scenes[i], "-o", picture, "--size", "41x37", "--spp", "1", "--eye",
                     "9,9,6", "--target", "0,1,0", "--up", "0,1,0", "--fov", "50", "--instanced"});
    ASSERT_EQ(result.exit_code, 0) << result.errors;
    pictures[i] = read_bytes(picture);
  }
  EXPECT_TRUE(pictures[0] == pictures[1]);
  EXPECT_TRUE(pictures[0] == pictures[2]);
}

TEST(Build, DamagedFilesAreErrors) {
  const TemporaryFolder folder;
  const std::string path = build(folder, {});
  std::string bytes = read_bytes(path);
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  folder.write("bad.kiwami", bytes);
  folder.write("short.kiwami", bytes.substr(0, bytes.size() / 3));
  folder.write("text.kiwami",
               "no file of the library, and longer than the header that it "
               "would have to begin with....");
  for (const char* name : {"bad.kiwami", "short.kiwami", "text.kiwami"}) {
    const CommandResult result =
        run_command({"render", folder / name, "-o", folder / "x.ppm", "--size", "4x4"});
    EXPECT_EQ(complaint_about_failure(result), "") << name;
  }
}

TEST(Build, RefusesAFolder) {
  const TemporaryFolder folder;
  const CommandResult result = run_command({"build", "sphere:1", "-o", folder / "."});
  EXPECT_EQ(complaint_about_failure(result), "");
  EXPECT_NE(result.errors.find("is a folder"), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace kiwami_tests
