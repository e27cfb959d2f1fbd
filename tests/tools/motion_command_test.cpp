// SPDX-License-Identifier: Apache-2.0
// Scenes in motion on the command line: pictures with an open shutter, and rows next to Embree.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "run_command.h"

namespace kiwami_tests {
namespace {

class MotionCommand : public testing::Test {
 protected:
  std::string picture_of(const std::string& scene, const std::vector<std::string>& more) const {
    std::vector<std::string> arguments = {"render", scene,    "-o",    folder_ / "picture.ppm",
                                          "--size", "48x36",  "--spp", "4",
                                          "--mode", "normals"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return read_bytes(folder_ / "picture.ppm");
  }

  /// The part of the bytes that differ by more than rounding.
  static double difference(const std::string& a, const std::string& b) {
    EXPECT_EQ(a.size(), b.size());
    size_t different = 0;
    for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
      different += std::abs(static_cast<int>(static_cast<unsigned char>(a[i])) -
                            static_cast<int>(static_cast<unsigned char>(b[i]))) > 2;
    }
    return static_cast<double>(different) / static_cast<double>(a.size());
  }

  /// Two triangles at a height.
  std::string square_file(const std::string& name, float z) const {
    std::string text;
    for (const char* corner : {"-1 -1 ", "1 -1 ", "1 1 ", "-1 1 "}) {
      text += std::string("v ") + corner + std::to_string(z) + "\n";
    }
    return folder_.write(name, text + "f 1 2 3\nf 1 3 4\n");
  }

  const TemporaryFolder folder_;
};

TEST_F(MotionCommand, RendersAnOpenShutter) {
  const std::string still = picture_of("terrain:24", {});
  const std::vector<std::string> view = {"--motion", "meshes", "--eye", "3,2,3",
                                         "--target", "0,0,0",  "--up",  "0,1,0"};
  const auto at = [&](const std::string& shutter) {
    std::vector<std::string> more = view;
    more.insert(more.end(), {"--shutter", shutter});
    return picture_of("terrain:24", more);
  };
  const std::string open = at("0,1"), begin = at("0,0"), end = at("1,1");
  EXPECT_GT(difference(begin, end), 0.01);
  EXPECT_GT(difference(open, begin), 0.01);
  EXPECT_GT(difference(open, end), 0.01);
  EXPECT_EQ(at("0,0"), begin);
  EXPECT_FALSE(still.empty());
}

TEST_F(MotionCommand, RendersKeyframePairs) {
  const std::string start = square_file("start.obj", 0.0f), end = square_file("end.obj", 0.5f);
  const std::vector<std::string> view = {"--eye", "0,-4,2", "--target", "0,0,0", "--up", "0,0,1"};
  std::vector<std::string> at_end = view;
  at_end.insert(at_end.end(), {"--motion", end, "--shutter", "1,1"});
  EXPECT_EQ(difference(picture_of(start, at_end), picture_of(end, view)), 0.0);
  std::vector<std::string> at_start = view;
  at_start.insert(at_start.end(), {"--motion", end, "--shutter", "0,0"});
  EXPECT_EQ(difference(picture_of(start, at_start), picture_of(start, view)), 0.0);
}

TEST_F(MotionCommand, RendersMovingInstances) {
  const std::string still = picture_of("room:3000", {"--instanced"});
  const auto moving_at = [&](const std::string& shutter) {
    return picture_of("room:3000", {"--instanced", "--motion", "instances", "--shutter", shutter});
  };
  // The camera is that of the scene; boxes of all times are larger, which nothing here depends on.
  EXPECT_LT(difference(moving_at("0,0"), still), 0.01);
  EXPECT_GT(difference(moving_at("1,1"), still), 0.05);
}

TEST_F(MotionCommand, BenchMeasuresMotionNextToEmbree) {
  // Not with AVX-512: rtcOccluded16 of Embree 3.13.5 does not end there where there are instances.
  const std::vector<std::vector<std::string>> scenes = {
      {"terrain:24", "--motion", "meshes"}, {"room:3000", "--instanced", "--motion", "instances"}};
  for (const std::vector<std::string>& scene : scenes) {
    std::vector<std::string> arguments = {"bench", "--ray-count", "400",       "--rounds",
                                          "1",     "--rays",      "bounce,ao", "--threads",
                                          "1",     "--isa",       "sse"};
    arguments.insert(arguments.end(), scene.begin(), scene.end());
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
    EXPECT_NE(result.output.find(" moving"), std::string::npos) << result.output;
  }
}

TEST_F(MotionCommand, WrongArgumentsAreRefusedInOneSentence) {
  const std::string picture = folder_ / "a.png", start = square_file("start.obj", 0.0f);
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"render", "sphere:1", "-o", picture, "--motion", "instances"}, "no instances"},
      {{"render", "sphere:1", "-o", picture, "--motion", start}, "other triangles"},
      {{"render", "sphere:1", "-o", picture, "--motion", "meshes", "--shutter", "1"}, "--shutter"},
      {{"render", "sphere:1", "-o", picture, "--motion", "meshes", "--shutter", "1,0"},
       "--shutter"},
      {{"render", "sphere:1", "-o", picture, "--motion", "meshes", "--shutter", "0,2"},
       "--shutter"},
      {{"render", "sphere:1", "-o", picture, "--motion", "meshes", "--shutter", "a,b"},
       "--shutter"},
      {{"render", "sphere:1", "-o", picture, "--motion", "meshes", "--leaf-mask", "2"},
       "--leaf-mask"},
      {{"bench", "sphere:1", "--motion", "meshes", "--vs", "binary"}, "--motion"},
      {{"bench", "sphere:1", "--motion", "meshes", "--queries", "filter"}, "--motion"}};
  for (const auto& [arguments, word] : cases) {
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(complaint_about_failure(result), "") << word;
    EXPECT_NE(result.errors.find(word), std::string::npos) << word << "\n" << result.errors;
  }
}

}  // namespace
}  // namespace kiwami_tests
