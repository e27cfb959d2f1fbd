// SPDX-License-Identifier: Apache-2.0
// Whatever is wrong, the command exits with 2 and says so in one sentence.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "run_command.h"

namespace kiwami_tests {
namespace {

/// Runs a command that must fail; its sentence must hold `word`.
void expect_failure(const std::vector<std::string>& arguments, const std::string& word) {
  const CommandResult result = run_command(arguments);
  std::string line;
  for (const std::string& argument : arguments) line += argument + " ";
  EXPECT_EQ(complaint_about_failure(result), "") << line;
  EXPECT_NE(result.errors.find(word), std::string::npos) << line << "\n" << result.errors;
}

class SceneErrors : public testing::Test {
 protected:
  void expect_bad_scene(const std::string& scene, const std::string& word) {
    expect_failure({"render", scene, "-o", folder_ / "out.png"}, word);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out.png"));
    expect_failure({"verify", scene}, word);
    expect_failure({"demo", scene}, word);
    expect_failure({"bench", scene}, word);
    expect_failure({"inspect", scene, "--json", folder_ / "out.json"}, word);
  }

  TemporaryFolder folder_;
};

TEST_F(SceneErrors, MissingFile) { expect_bad_scene(folder_ / "none.obj", "there is no file"); }

TEST_F(SceneErrors, Directory) { expect_bad_scene(folder_ / ".", "is a directory"); }

TEST_F(SceneErrors, EmptyFile) {
  expect_bad_scene(folder_.write("empty.obj", ""), "is empty");
  expect_bad_scene(folder_.write("empty.tri.gz", ""), "is empty");
}

TEST_F(SceneErrors, UnknownFormat) {
  expect_bad_scene(folder_.write("scene.xyz", "1 2 3\n"), "format");
}

TEST_F(SceneErrors, Unreadable) {
  if (geteuid() == 0) GTEST_SKIP() << "root reads everything";
  const std::string path = folder_.write("secret.obj", "v 0 0 0\n");
  std::filesystem::permissions(path, std::filesystem::perms::none);
  expect_bad_scene(path, "cannot read");
}

TEST_F(SceneErrors, BrokenObj) {
  expect_bad_scene(folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 x\n"), "line 4");
  expect_bad_scene(folder_.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n"),
                   "does not exist");
  expect_bad_scene(folder_.write("c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3 9\n"),
                   "does not exist");
}

TEST_F(SceneErrors, ObjWithoutFaces) {
  expect_bad_scene(folder_.write("points.obj", "v 0 0 0\nv 1 0 0\n"), "no triangles");
}

TEST_F(SceneErrors, TruncatedAndBrokenCompression) {
  expect_bad_scene(folder_.write("a.tri", "TRI1\4"), "truncated");
  expect_bad_scene(folder_.write("b.tri.gz", std::string("\x1f\x8b\x08\0\0\0\0\0\0\3\x0b", 11)),
                   "truncated");
  expect_bad_scene(
      folder_.write("c.tri.gz", std::string("\x1f\x8b\x08\0\0\0\0\0\0\3\xff\xff\xff", 13)),
      "broken");
}

TEST_F(SceneErrors, WrongSignature) {
  expect_bad_scene(folder_.write("a.tri", "TRI2\1\0\0\0"), "does not begin with");
  expect_bad_scene(folder_.write("a.ins", "TRI1\1\0\0\0"), "does not begin with");
}

TEST_F(SceneErrors, ProceduralNumbers) {
  expect_bad_scene("sphere:10", "LEVEL");
  expect_bad_scene("sphere:", "LEVEL");
  expect_bad_scene("terrain:0", "N");
  expect_bad_scene("soup:5", "SEED");
  expect_bad_scene("soup:5:1:2", "more numbers");
}

TEST(Errors, CommandLine) {
  expect_failure({}, "no command");
  expect_failure({"paint"}, "paint");
  expect_failure({"render"}, "required");
  expect_failure({"render", "sphere:1"}, "output");
  expect_failure({"info", "--nonsense"}, "nonsense");
}

TEST(Errors, OptionValues) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"--spp", "0"},        {"--spp", "-3"},        {"--spp", "nan"},
      {"--spp", "99999999"}, {"--spp", "1.5"},       {"--bounces", "9"},
      {"--fov", "nan"},      {"--fov", "inf"},       {"--fov", "0"},
      {"--fov", "180"},      {"--eye", "1,2"},       {"--eye", "nan,0,0"},
      {"--eye", "1,2,3,4"},  {"--target", "a,b,c"},  {"--target", "1e30,0,0"},
      {"--up", "0,0,0"},     {"--size", "0x5"},      {"--size", "640"},
      {"--size", "99999x9"}, {"--size", "-4x4"},     {"--mode", "beautiful"},
      {"--isa", "mmx"},      {"--bvh-width", "5"},   {"--bvh-width", "-8"},
      {"--threads", "-1"},   {"--threads", "99999"}, {"--threads", "two"}};
  for (const auto& [option, value] : cases) {
    expect_failure({"render", "sphere:1", "-o", folder / "a.png", option, value}, option);
  }
  expect_failure({"verify", "sphere:1", "--rays", "0"}, "--rays");
  expect_failure({"verify", "sphere:1", "--seed", "-1"}, "--seed");
  expect_failure({"demo", "sphere:1", "--rounds", "nan"}, "--rounds");
}

TEST(Errors, CameraWithoutDirection) {
  const TemporaryFolder folder;
  expect_failure(
      {"render", "sphere:1", "-o", folder / "a.png", "--eye", "1,2,3", "--target", "1,2,3"},
      "same point");
  expect_failure(
      {"render", "sphere:1", "-o", folder / "a.png", "--eye", "0,5,0", "--target", "0,0,0"}, "up");
}

TEST(Errors, UnwritableOutputIsFoundBeforeTheSceneIsRead) {
  const TemporaryFolder folder;
  for (const std::string output : {"/nonexistent-folder/a.png", "/proc/a.png"}) {
    expect_failure({"render", folder / "no-such-scene.obj", "-o", output}, "cannot be written");
  }
  expect_failure({"render", "sphere:1", "-o", folder / "a.bmp"}, ".png");
  std::filesystem::create_directory(folder / "folder.png");
  expect_failure({"render", "sphere:1", "-o", folder / "folder.png"}, "directory");
  expect_failure({"demo", "sphere:1", "--json", "/nonexistent-folder/a.json"}, "--json");
}

TEST(Errors, AnExistingPictureSurvivesAFailure) {
  const TemporaryFolder folder;
  const std::string picture = folder.write("old.png", "precious");
  expect_failure({"render", folder / "none.obj", "-o", picture}, "there is no file");
  EXPECT_EQ(read_bytes(picture), "precious");
}

TEST(Errors, IsaOfTheEnvironment) {
  ASSERT_EQ(setenv("KIWAMI_ISA", "mmx", 1), 0);
  expect_failure({"info"}, "KIWAMI_ISA");
  unsetenv("KIWAMI_ISA");
}

}  // namespace
}  // namespace kiwami_tests
