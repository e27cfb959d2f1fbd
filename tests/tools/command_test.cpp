// SPDX-License-Identifier: Apache-2.0
// The command does what it says.
#include <gtest/gtest.h>

#include <limits>
#include <sstream>

#include "run_command.h"

namespace kiwami_tests {
namespace {

/// The ISAs that `info` says can run here.
std::vector<std::string> available_isas() {
  const CommandResult info = run_command({"info"});
  std::istringstream lines(info.output);
  std::vector<std::string> isas;
  std::string line;
  const std::string label = "ISAs available";
  while (std::getline(lines, line)) {
    if (!line.starts_with(label)) continue;
    std::istringstream words(line.substr(label.size()));
    std::string word;
    while (words >> word) isas.push_back(word.substr(0, word.find(',')));
  }
  return isas;
}

std::string rendered(const TemporaryFolder& folder, const std::vector<std::string>& options) {
  const std::string picture = folder / "picture.ppm";
  std::vector<std::string> arguments = {"render", "sphere:3", "-o",    picture,
                                        "--size", "61x47",    "--spp", "2"};
  arguments.insert(arguments.end(), options.begin(), options.end());
  const CommandResult result = run_command(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  return read_bytes(picture);
}

TEST(Command, ExplainsEachOfItsCommands) {
  for (const char* command : {"info", "build", "render", "verify", "demo", "bench", "inspect"}) {
    const CommandResult result = run_command({command, "--help"});
    EXPECT_EQ(result.exit_code, 0) << command;
    EXPECT_NE(result.output.find("Usage:"), std::string::npos) << command;
    EXPECT_EQ(result.errors, "");
    EXPECT_NE(run_command({"--help"}).output.find(command), std::string::npos);
  }
}

TEST(Command, InfoNamesScalarAndTheDefault) {
  const CommandResult text = run_command({"info"});
  EXPECT_EQ(text.exit_code, 0) << text.errors;
  EXPECT_NE(text.output.find("version"), std::string::npos);
  ASSERT_FALSE(available_isas().empty());
  EXPECT_EQ(available_isas().front(), "scalar");
  const CommandResult json = run_command({"info", "--json"});
  EXPECT_EQ(json.exit_code, 0) << json.errors;
  EXPECT_EQ(json.output.front(), '{');
  EXPECT_NE(json.output.find("\"isas_available\""), std::string::npos);
}

TEST(Command, RendersTheSameBytesOnEveryIsaWidthAndThreadCount) {
  const TemporaryFolder folder;
  for (const char* mode : {"normals", "ao", "path"}) {
    const std::string expected =
        rendered(folder, {"--mode", mode, "--isa", "scalar", "--bvh-width", "4", "--threads", "1"});
    EXPECT_EQ(expected.size(), std::string("P6\n61 47\n255\n").size() + 61 * 47 * 3);
    for (const std::string& isa : available_isas()) {
      for (const char* width : {"4", "8", "16"}) {
        EXPECT_TRUE(expected == rendered(folder, {"--mode", mode, "--isa", isa, "--bvh-width",
                                                  width, "--threads", "2"}))
            << mode << " on " << isa << ", width " << width;
      }
    }
  }
}

TEST(Command, RendersAPictureThatIsNotFlat) {
  const TemporaryFolder folder;
  const std::string picture = rendered(folder, {"--mode", "normals"});
  const std::string background = picture.substr(picture.size() - 3);
  size_t other = 0;
  for (size_t i = std::string("P6\n61 47\n255\n").size(); i + 2 < picture.size(); i += 3) {
    if (picture.compare(i, 3, background) != 0) ++other;
  }
  EXPECT_GT(other, 61 * 47 / 10);
  EXPECT_LT(other, 61 * 47 * 9 / 10);
}

TEST(Command, WritesPng) {
  const TemporaryFolder folder;
  const std::string picture = folder / "picture.png";
  const CommandResult result =
      run_command({"render", "sphere:1", "-o", picture, "--size", "16x16", "--spp", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(read_bytes(picture).substr(1, 3), "PNG");
}

TEST(Command, CountsTrianglesThatItSkips) {
  const TemporaryFolder folder;
  std::string tri("TRI1\4\0\0\0\2\0\0\0", 12);
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float vertices[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, nan, 0, 0};
  const uint32_t indices[6] = {0, 1, 2, 0, 1, 3};
  tri.append(reinterpret_cast<const char*>(vertices), sizeof vertices);
  tri.append(reinterpret_cast<const char*>(indices), sizeof indices);
  const CommandResult result = run_command({"render", folder.write("nan.tri", tri), "-o",
                                            folder / "a.ppm", "--size", "8x8", "--spp", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_NE(result.output.find("1 triangles are skipped"), std::string::npos) << result.output;
}

TEST(Command, VerifiesSmallScenes) {
  for (const char* scene : {"sphere:0", "sphere:3", "terrain:24", "soup:1:1", "soup:700:5"}) {
    const CommandResult result = run_command({"verify", scene, "--rays", "700", "--seed", "3"});
    EXPECT_EQ(result.exit_code, 0) << scene << "\n" << result.output << result.errors;
    EXPECT_NE(result.output.find("\nverified\n"), std::string::npos) << result.output;
    for (const std::string& isa : available_isas()) {
      EXPECT_NE(result.output.find("\n" + isa + " "), std::string::npos) << isa;
    }
  }
}

TEST(Command, VerifiesInstances) {
  for (const char* scene : {"room:3000", "forest:3"}) {
    const CommandResult result =
        run_command({"verify", scene, "--instanced", "--rays", "200", "--seed", "4"});
    EXPECT_EQ(result.exit_code, 0) << scene << "\n" << result.output << result.errors;
    EXPECT_NE(result.output.find("\nverified\n"), std::string::npos) << result.output;
  }
}

TEST(Command, RendersInstancesAsTheyAreFlattened) {
  const TemporaryFolder folder;
  const auto picture_of = [&](const std::vector<std::string>& more) {
    std::vector<std::string> arguments = {"render", "room:3000", "-o",    folder / "picture.ppm",
                                          "--size", "40x30",     "--spp", "1",
                                          "--mode", "normals"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    return read_bytes(folder / "picture.ppm");
  };
  const std::string flat = picture_of({}), instanced = picture_of({"--instanced"});
  ASSERT_EQ(flat.size(), instanced.size());
  size_t different = 0;
  for (size_t i = 0; i < flat.size(); ++i) {
    different += std::abs(static_cast<int>(static_cast<unsigned char>(flat[i])) -
                          static_cast<int>(static_cast<unsigned char>(instanced[i]))) > 2;
  }
  // At silhouettes either may be seen.
  EXPECT_LT(different, flat.size() / 100);
}

TEST(Command, BenchMeasuresInstances) {
  // Not with AVX-512: rtcOccluded16 of Embree 3.13.5 does not end there where there are instances.
  const CommandResult result = run_command(
      {"bench", "room:3000", "--instanced", "--ray-count", "400", "--rounds", "1", "--rays",
       "bounce,ao", "--threads", "1", "--param", "rebraid=1", "--isa", "sse"});
  EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
  EXPECT_NE(result.output.find("room:3000 instanced"), std::string::npos) << result.output;
  EXPECT_EQ(run_command({"bench", "room:3000", "--instanced", "--vs", "binary"}).exit_code, 2);
}

TEST(Command, DemoPrintsEveryIsaAndWritesBothFiles) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_command({"demo", "sphere:2", "soup:50:1", "--rounds", "1", "-o", folder / "demo.png",
                   "--json", folder / "demo.json", "--spp", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
  EXPECT_EQ(read_bytes(folder / "demo.png").substr(1, 3), "PNG");
  const std::string json = read_bytes(folder / "demo.json");
  for (const std::string& isa : available_isas()) {
    EXPECT_NE(result.output.find("\n" + isa + " "), std::string::npos) << isa;
    EXPECT_NE(json.find("\"" + isa + "\""), std::string::npos) << isa;
  }
  EXPECT_EQ(json.find("\"bits_equal_to_scalar\": false"), std::string::npos);
}

}  // namespace
}  // namespace kiwami_tests
