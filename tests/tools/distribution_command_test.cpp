// SPDX-License-Identifier: Apache-2.0
// `kiwami bench` with --distributions, --tetrahedra or --binary-layouts.
#include <gtest/gtest.h>

#include <map>
#include <nlohmann/json.hpp>

#include "run_command.h"

namespace kiwami_tests {
namespace {

using Json = nlohmann::json;

TEST(DistributionCommand, BenchComparesTheMethods) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_command({"bench", "--distributions", "room:8000", "--ray-count", "20000", "--rounds", "3",
                   "--json", folder / "rows.json"});
  ASSERT_EQ(result.exit_code, 0) << result.output << result.errors;
  EXPECT_NE(result.output.find("radix_tree_forest"), std::string::npos) << result.output;
  std::map<std::string, Json> rows;
  for (const Json& row : Json::parse(read_bytes(folder / "rows.json"), nullptr, false)) {
    for (const char* key : {"weights", "bytes_per_weight", "mean_steps", "most_steps",
                            "mega_draws_per_second", "ratio", "unevenness"}) {
      EXPECT_GT(row.at(key).get<double>(), 0.0) << key << " of " << row;
    }
    EXPECT_EQ(row.at("wrong"), "");
    rows[row.at("method")] = row;
  }
  ASSERT_EQ(rows.size(), 3u);
  const Json& forest = rows.at("radix_tree_forest");
  EXPECT_EQ(forest.at("draws_hash"), rows.at("binary_search").at("draws_hash"));
  EXPECT_NE(forest.at("draws_hash"), rows.at("alias_table").at("draws_hash"));
  EXPECT_LT(forest.at("mean_steps").get<double>(),
            rows.at("binary_search").at("mean_steps").get<double>() / 4);
  // What a low-discrepancy sequence is for.
  EXPECT_LT(forest.at("unevenness").get<double>(),
            rows.at("alias_table").at("unevenness").get<double>());
}

TEST(TetrahedronCommand, BenchComparesTheMethods) {
  const TemporaryFolder folder;
  const CommandResult result = run_command({"bench", "--tetrahedra", "6", "--ray-count", "5000",
                                            "--rounds", "1", "--json", folder / "rows.json"});
  ASSERT_EQ(result.exit_code, 0) << result.output << result.errors;
  EXPECT_NE(result.output.find("binary_walk"), std::string::npos) << result.output;
  std::map<std::string, int> methods;
  for (const Json& row : Json::parse(read_bytes(folder / "rows.json"), nullptr, false)) {
    EXPECT_EQ(row.at("tetrahedra"), 6 * 6 * 6 * 6);
    EXPECT_EQ(row.at("wrong"), "");
    EXPECT_GT(row.at("found").get<double>(), 0.75);
    EXPECT_LT(row.at("found").get<double>(), 1.0);
    EXPECT_GT(row.at("ratio").get<double>(), 0.0);
    ++methods[row.at("method")];
  }
  const std::map<std::string, int> expected = {{"binary_walk", 2}, {"boxes", 2}, {"faces", 2}};
  EXPECT_EQ(methods, expected);
  EXPECT_EQ(run_command({"bench", "--tetrahedra", "0"}).exit_code, 2);
}

TEST(LayoutCommand, BenchComparesTheLayoutsOfABinaryTree) {
  const TemporaryFolder folder;
  const CommandResult result =
      run_command({"bench", "--binary-layouts", "room:3000", "--builder", "sweep_sah", "--rays",
                   "primary,ao,random", "--ray-count", "3000", "--rounds", "1", "--json",
                   folder / "rows.json"});
  ASSERT_EQ(result.exit_code, 0) << result.output << result.errors;
  std::map<std::string, std::map<std::string, Json>> rows;
  for (const Json& row : Json::parse(read_bytes(folder / "rows.json"), nullptr, false)) {
    EXPECT_EQ(row.at("wrong"), "");
    rows[row.at("rays")][row.at("layout")] = row;
  }
  ASSERT_EQ(rows.size(), 2u) << "the sets of closest hits";
  for (auto& [name, layouts] : rows) {
    const Json &boxes = layouts["boxes"], &dual_split = layouts["dual_split"];
    EXPECT_LT(dual_split.at("node_bytes_per_triangle").get<double>(),
              0.6 * boxes.at("node_bytes_per_triangle").get<double>());
    EXPECT_LT(dual_split.at("plane_tests").get<double>(),
              0.5 * boxes.at("plane_tests").get<double>());
  }
  EXPECT_EQ(run_command({"bench", "--binary-layouts", "room:300", "--builder", "wide_top_down"})
                .exit_code,
            2);
}

TEST(DistributionCommand, ASceneThatIsNotThereIsAnError) {
  const CommandResult result = run_command({"bench", "--distributions", "nowhere.obj"});
  EXPECT_EQ(result.exit_code, 2);
  EXPECT_NE(result.errors.find("nowhere.obj"), std::string::npos) << result.errors;
}

}  // namespace
}  // namespace kiwami_tests
