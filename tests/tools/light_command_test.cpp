// SPDX-License-Identifier: Apache-2.0
// `kiwami bench --lights` and `kiwami render --lights`: many lights from the command line.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "run_command.h"

namespace kiwami_tests {
namespace {

using Json = nlohmann::json;

TEST(LightCommand, BenchComparesMethodsAndWidths) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_command({"bench", "--lights", "room:2000", "--light-share", "0.3", "--light-receivers",
                   "256", "--light-samples", "8", "--rounds", "1", "--json", folder / "rows.json"});
  ASSERT_EQ(result.exit_code, 0) << result.output << result.errors;
  const Json rows = Json::parse(read_bytes(folder / "rows.json"), nullptr, false);
  // Power and the roulettes once, the others at four widths.
  ASSERT_EQ(rows.size(), 8u + 3 * 4);
  std::map<std::string, double> errors;
  for (const Json& row : rows) {
    for (const char* key : {"lights", "receivers", "mega_choices_per_second", "mse",
                            "mse_equal_time", "bytes_per_light", "choices_per_receiver"}) {
      EXPECT_GT(row.at(key).get<double>(), 0.0) << key << " of " << row;
    }
    errors[row.at("method")] += row.at("mse").get<double>();
  }
  // Where lights are all around, those that are near and face the receiver matter.
  EXPECT_LT(errors["tree"] / 4, errors["power"]);
  EXPECT_LT(errors["tree_splitting"] / 4, errors["power"]);
  EXPECT_LT(errors["lightcuts"] / 4, errors["power"]);
  EXPECT_LT(errors["roulette"], errors["power"]);
  EXPECT_LT(errors["lazy_roulette"], errors["power"]);
}

TEST(LightCommand, ShadowRaysCountInTheTime) {
  const TemporaryFolder folder;
  std::vector<std::string> arguments = {"bench",
                                        "--lights",
                                        "room:1000",
                                        "--light-share",
                                        "0.3",
                                        "--light-receivers",
                                        "64",
                                        "--light-samples",
                                        "16",
                                        "--light-widths",
                                        "8",
                                        "--rounds",
                                        "1",
                                        "--light-methods",
                                        "power,tree",
                                        "--json",
                                        folder / "rows.json"};
  const auto speed_of_power = [&] {
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
    const Json rows = Json::parse(read_bytes(folder / "rows.json"), nullptr, false);
    EXPECT_EQ(rows.size(), 2u);
    EXPECT_LT(rows.at(1).at("mse"), rows.at(0).at("mse"));
    return rows.at(0).at("mega_choices_per_second").get<double>();
  };
  const double plain = speed_of_power();
  arguments.push_back("--light-shadows");
  EXPECT_LT(speed_of_power(), plain);
}

TEST(LightCommand, GlossyReceiversGainByTheirLobe) {
  const TemporaryFolder folder;
  const CommandResult result = run_command(
      {"bench", "--lights", "room:2000", "--light-share", "0.3", "--light-receivers", "256",
       "--light-samples", "16", "--light-widths", "8", "--light-roughness", "0.1", "--rounds", "1",
       "--light-methods", "power,tree,tree_glossy,tree_mixed,roulette,roulette_glossy", "--json",
       folder / "rows.json"});
  ASSERT_EQ(result.exit_code, 0) << result.output << result.errors;
  std::map<std::string, double> errors;
  for (const Json& row : Json::parse(read_bytes(folder / "rows.json"), nullptr, false)) {
    errors[row.at("method")] = row.at("mse").get<double>();
  }
  ASSERT_EQ(errors.size(), 6u);
  EXPECT_LT(errors["tree_glossy"], errors["tree"]);
  EXPECT_LT(errors["tree_mixed"], errors["tree"]);
  EXPECT_LT(errors["roulette_glossy"], errors["roulette"]);
}

TEST(LightCommand, PicturesAreTheSameOnEveryIsaAndNumberOfThreads) {
  const TemporaryFolder folder;
  const auto render = [&](const std::vector<std::string>& options) {
    const std::string picture = folder / "picture.ppm";
    std::vector<std::string> arguments = {"render", "room:1000", "-o", picture,         "--size",
                                          "24x16",  "--spp",     "4",  "--light-share", "0.2"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.errors;
    EXPECT_NE(result.output.find("emissive triangles"), std::string::npos) << result.output;
    return read_bytes(picture);
  };
  for (const char* method :
       {"power", "tree", "tree_splitting", "lightcuts", "culling", "roulette", "roulette_sphere",
        "lazy_roulette", "lazy_scrambled", "roulette_dithered", "lazy_dithered"}) {
    const std::string scalar =
        render({"--lights", method, "--isa", "scalar", "--bvh-width", "8", "--threads", "1"});
    EXPECT_GT(scalar.size(), 24u * 16 * 3);
    EXPECT_TRUE(scalar == render({"--lights", method, "--bvh-width", "8", "--threads", "2"}))
        << method;
  }
  EXPECT_FALSE(render({"--lights", "tree"}) == render({"--lights", "power"}));
  for (const char* method : {"tree_glossy", "tree_mixed", "lightcuts_glossy"}) {
    const std::vector<std::string> glossy = {"--lights", method,        "--light-roughness",
                                             "0.2",      "--bvh-width", "8"};
    std::vector<std::string> scalar = glossy;
    scalar.insert(scalar.end(), {"--isa", "scalar"});
    EXPECT_TRUE(render(glossy) == render(scalar)) << method;
  }
}

TEST(LightCommand, WrongArgumentsAreRefusedInOneSentence) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"bench", "--lights", "sphere:1", "--light-methods", "sun"}, "sun"},
      {{"bench", "--lights", "sphere:1", "--light-widths", "3"}, "--light-widths"},
      {{"bench", "--lights", "sphere:1", "--light-methods", "tree_glossy"}, "--light-roughness"},
      {{"render", "sphere:1", "-o", folder / "a.png", "--lights", "tree_mixed"},
       "--light-roughness"},
      {{"bench", "--lights", "sphere:1", "--light-share", "2"}, "--light-share"},
      {{"bench", "--lights", "sphere:1", "--light-share", "0"}, "no triangle"},
      {{"render", "sphere:1", "-o", folder / "a.png", "--lights", "candles"}, "candles"},
      {{"render", "sphere:1", "-o", folder / "a.png", "--lights", "tree", "--instanced"},
       "--instanced"}};
  for (const auto& [arguments, word] : cases) {
    const CommandResult result = run_command(arguments);
    EXPECT_EQ(complaint_about_failure(result), "") << word;
    EXPECT_NE(result.errors.find(word), std::string::npos) << word << "\n" << result.errors;
  }
}

}  // namespace
}  // namespace kiwami_tests
