// SPDX-License-Identifier: Apache-2.0
// `kiwami inspect`: its data and its refusals. The page is judged by tests/page.
#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "run_command.h"

namespace kiwami_tests {
namespace {

using Json = nlohmann::json;

enum Kind : int { kInner = 0, kLeaf = 1, kFolded = 2, kGroup = 3 };

/// What the command writes for a scene and options.
Json inspected(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  arguments.insert(arguments.begin(), "inspect");
  arguments.insert(arguments.end(), {"--json", folder / "tree.json"});
  const CommandResult result = run_command(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  EXPECT_EQ(result.errors, "");
  return Json::parse(read_bytes(folder / "tree.json"));
}

/// The same but for the time that it took.
Json without_times(Json json) {
  for (Json& pipeline : json.at("pipelines")) pipeline.erase("build_seconds");
  return json;
}

/// The sum of a column over what the rows stand for by themselves.
double sum_of(const Json& nodes, const std::string& own, const std::string& whole) {
  double sum = 0.0;
  for (size_t i = 0; i < nodes.at("kind").size(); ++i) {
    const bool is_whole = nodes.at("kind")[i] >= kFolded;
    sum += nodes.at(is_whole ? whole : own)[i].get<double>();
  }
  return sum;
}

void expect_sound(const Json& pipeline, size_t most_rows) {
  const Json& nodes = pipeline.at("nodes");
  const size_t count = nodes.at("parent").size();
  ASSERT_GT(count, 0u);
  EXPECT_LE(count, most_rows);
  for (const auto& [name, column] : nodes.items()) {
    EXPECT_EQ(column.size(), name == "box" ? count * 6 : count) << name;
  }
  EXPECT_EQ(nodes.at("parent")[0], -1);
  EXPECT_EQ(nodes.at("subtree_nodes")[0], pipeline.at("tree_node_count"));
  const double cost = pipeline.at("sah_cost");
  EXPECT_NEAR(nodes.at("subtree_cost")[0].get<double>(), cost, 1e-5 * cost);
  EXPECT_NEAR(sum_of(nodes, "cost", "subtree_cost"), cost, 1e-4 * cost);
  for (size_t i = 1; i < count; ++i) {
    const int parent = nodes.at("parent")[i];
    ASSERT_GE(parent, 0);
    ASSERT_LT(parent, static_cast<int>(i));
    EXPECT_EQ(nodes.at("kind")[static_cast<size_t>(parent)], kInner);
    EXPECT_EQ(nodes.at("depth")[i].get<int>(),
              nodes.at("depth")[static_cast<size_t>(parent)].get<int>() + 1);
    for (size_t bound = 0; bound < 6; ++bound) {
      const float own = nodes.at("box")[6 * i + bound];
      const float around = nodes.at("box")[6 * static_cast<size_t>(parent) + bound];
      EXPECT_TRUE(bound < 3 ? own >= around : own <= around) << i << " " << bound;
    }
  }
}

TEST(Inspect, WritesEveryNodeOfASmallTree) {
  const Json json = inspected({"sphere:3"});
  EXPECT_EQ(json.at("format"), "kiwami-inspect");
  EXPECT_EQ(json.at("format_version"), 1);
  EXPECT_EQ(json.at("scene").at("name"), "sphere:3");
  EXPECT_EQ(json.at("scene").at("triangle_count"), 1280);
  EXPECT_EQ(json.at("scene").at("shape").at("triangles").size(), 1280u * 3);
  EXPECT_EQ(json.at("scene").at("bounds").size(), 6u);
  ASSERT_EQ(json.at("pipelines").size(), 1u);
  const Json& pipeline = json.at("pipelines")[0];
  EXPECT_EQ(pipeline.at("name"), "wide_top_down + reorder_sato, merged");
  expect_sound(pipeline, 10000);
  const Json& nodes = pipeline.at("nodes");
  EXPECT_EQ(nodes.at("parent").size(), pipeline.at("tree_node_count"));
  EXPECT_EQ(nodes.at("primitives")[0], 1280);
  EXPECT_NEAR(sum_of(nodes, "overlap", "overlap"), pipeline.at("epo").get<double>(), 1e-4);
  uint64_t primitives = 0;
  for (size_t i = 0; i < nodes.at("kind").size(); ++i) {
    const int kind = nodes.at("kind")[i];
    EXPECT_TRUE(kind == kInner || kind == kLeaf);
    EXPECT_EQ(nodes.at("members")[i], 1);
    if (kind == kLeaf) primitives += nodes.at("primitives")[i].get<uint64_t>();
  }
  EXPECT_EQ(primitives, 1280u);
}

TEST(Inspect, JoinsWhatCostsLittle) {
  const Json json = inspected({"terrain:50", "--nodes", "200", "--pipeline", "ploc"});
  const Json& pipeline = json.at("pipelines")[0];
  expect_sound(pipeline, 200);
  EXPECT_GT(pipeline.at("tree_node_count"), 500);
  const Json& kinds = pipeline.at("nodes").at("kind");
  EXPECT_GE(std::count(kinds.begin(), kinds.end(), Json(kGroup)), 10);
}

TEST(Inspect, ComparesPipelines) {
  const Json json = inspected({"soup:500:1", "--pipeline", "ploc+rotation,surface_area,unmerged",
                               "--pipeline", "lbvh + parallel_reinsertion + rotation, merged",
                               "--pipeline", "binned_sah,unmerged", "--bvh-width", "4"});
  std::vector<std::string> names;
  for (const Json& pipeline : json.at("pipelines")) {
    names.push_back(pipeline.at("name"));
    EXPECT_EQ(pipeline.at("bvh_width"), 4);
    expect_sound(pipeline, 10000);
  }
  EXPECT_EQ(names,
            (std::vector<std::string>{"ploc + rotation, surface_area, unmerged",
                                      "lbvh + parallel_reinsertion + rotation, optimal, merged",
                                      "binned_sah, optimal, unmerged"}));
}

TEST(Inspect, IsTheSameForEveryThreadCountAndIsa) {
  const std::vector<std::string> options = {"terrain:30", "--nodes", "300", "--bvh-width", "8"};
  const auto with = [&](const std::string& option, const std::string& value) {
    std::vector<std::string> all = options;
    all.insert(all.end(), {option, value});
    return without_times(inspected(all));
  };
  const Json expected = with("--isa", "scalar");
  EXPECT_EQ(with("--threads", "1"), expected);
  EXPECT_EQ(with("--threads", "2"), expected);
}

TEST(Inspect, LeavesOutWhatIsNotWanted) {
  const Json json = inspected({"sphere:2", "--rays", "none", "--no-overlap"});
  const Json& pipeline = json.at("pipelines")[0];
  EXPECT_FALSE(json.contains("rays"));
  EXPECT_FALSE(pipeline.contains("epo"));
  EXPECT_FALSE(pipeline.contains("visits_per_ray"));
  EXPECT_FALSE(pipeline.at("nodes").contains("overlap"));
  EXPECT_FALSE(pipeline.at("nodes").contains("visits"));
}

TEST(Inspect, CountsVisitsOfTheChosenRays) {
  const Json json = inspected({"sphere:3", "--rays", "primary", "--ray-count", "400"});
  EXPECT_EQ(json.at("rays").at("name"), "primary");
  EXPECT_EQ(json.at("rays").at("count"), 400);
  const Json& pipeline = json.at("pipelines")[0];
  double visits = 0.0;
  for (const Json& share : pipeline.at("nodes").at("visits")) {
    EXPECT_GE(share, 0.0);
    EXPECT_LE(share, 1.0);
    visits += share.get<double>();
  }
  EXPECT_GT(visits, 1.0);
  EXPECT_NEAR(visits, pipeline.at("visits_per_ray").get<double>(), 1e-4 * visits);
}

TEST(Inspect, ReckonsWithTheCostsOfTheBuild) {
  const Json json = inspected({"sphere:3", "--param", "node_cost=3", "--param", "leaf_cost=0.5"});
  const Json& nodes = json.at("pipelines")[0].at("nodes");
  EXPECT_EQ(nodes.at("kind")[0], kInner);
  EXPECT_EQ(nodes.at("cost")[0], 3.0);
  for (size_t i = 0; i < nodes.at("kind").size(); ++i) {
    const double area = nodes.at("area")[i].get<double>() / nodes.at("area")[0].get<double>();
    EXPECT_NEAR(nodes.at("cost")[i], area * (nodes.at("kind")[i] == kLeaf ? 0.5 : 3.0), 1e-5);
  }
}

TEST(Inspect, TakesATreeOfNothing) {
  const TemporaryFolder folder;
  std::string tri("TRI1\3\0\0\0\1\0\0\0", 12);
  tri.append(36, '\xff');  // NaN
  tri.append("\0\0\0\0\1\0\0\0\2\0\0\0", 12);
  const Json json = inspected({folder.write("nothing.tri", tri)});
  EXPECT_EQ(json.at("scene").at("bounds"), Json::parse("[0, 0, 0, 0, 0, 0]"));
  EXPECT_EQ(json.at("pipelines")[0].at("nodes").at("parent").size(), 0u);
  EXPECT_EQ(json.at("pipelines")[0].at("sah_cost"), 0.0);
}

TEST(Inspect, ThePageHoldsTheData) {
  const TemporaryFolder folder;
  const std::string html = folder / "tree.html";
  const std::string json = folder / "tree.json";
  const CommandResult result = run_command({"inspect", "sphere:1", "--html", html, "--json", json});
  if (result.errors.find("this build has no page") != std::string::npos) {
    EXPECT_EQ(complaint_about_failure(result), "");
    EXPECT_FALSE(std::filesystem::exists(json));
    GTEST_SKIP() << "SKIPPED: npm was absent when the command was built";
  }
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_bytes(html);
  EXPECT_TRUE(page.starts_with("<!doctype html>"));
  std::string data = read_bytes(json);
  data.pop_back();
  EXPECT_NE(page.find(data), std::string::npos);
}

TEST(Inspect, ASceneNameCannotEndItsElement) {
  const TemporaryFolder folder;
  const std::string scene =
      folder.write("a<!--<script>b.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const CommandResult result = run_command({"inspect", scene, "--html", folder / "a.html"});
  if (result.errors.find("this build has no page") != std::string::npos) {
    GTEST_SKIP() << "SKIPPED: npm was absent when the command was built";
  }
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  const std::string page = read_bytes(folder / "a.html");
  EXPECT_EQ(page.find("a<!--"), std::string::npos);
  EXPECT_NE(page.find("a\\u003c!--\\u003cscript>b.obj"), std::string::npos);
}

TEST(Inspect, WrongArgumentsAreRefusedInOneSentence) {
  const TemporaryFolder folder;
  const std::string json = folder / "a.json";
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--json", json}, "required"},
      {{"sphere:1"}, "--html or --json"},
      {{folder / "none.obj", "--json", json}, "there is no file"},
      {{"sphere:1", "--json", "/nonexistent-folder/a.json"}, "--json"},
      {{"sphere:1", "--json", folder / "."}, "directory"},
      {{"sphere:1", "--json", json, "--pipeline", "best"}, "best"},
      {{"sphere:1", "--json", json, "--pipeline", ""}, "--pipeline"},
      {{"sphere:1", "--json", json, "--pipeline", "ploc+"}, "plus signs"},
      {{"sphere:1", "--json", json, "--pipeline", "ploc+ploc"}, "no optimizer 'ploc'"},
      {{"sphere:1", "--json", json, "--pipeline", "ploc,"}, "commas"},
      {{"sphere:1", "--json", json, "--pipeline", "ploc,narrow"}, "no contraction 'narrow'"},
      {{"sphere:1", "--json", json, "--pipeline"}, "--pipeline"},
      {{"sphere:1", "--json", json, "--param", "bins=3"}, "bins"},
      {{"sphere:1", "--json", json, "--rays", "x"}, "--rays"},
      {{"sphere:1", "--json", json, "--ray-count", "0"}, "--ray-count"},
      {{"sphere:1", "--json", json, "--ray-count", "nan"}, "--ray-count"},
      {{"sphere:1", "--json", json, "--nodes", "0"}, "--nodes"},
      {{"sphere:1", "--json", json, "--nodes", "-5"}, "--nodes"},
      {{"sphere:1", "--json", json, "--eye", "1,2"}, "--eye"},
      {{"sphere:1", "--json", json, "--isa", "mmx"}, "--isa"},
      {{"sphere:1", "--json", json, "--bvh-width", "5"}, "--bvh-width"},
      {{"sphere:1", "--json", json, "--nonsense"}, "nonsense"}};
  for (const auto& [options, word] : cases) {
    std::vector<std::string> arguments = {"inspect"};
    arguments.insert(arguments.end(), options.begin(), options.end());
    const CommandResult result = run_command(arguments);
    std::string line;
    for (const std::string& argument : arguments) line += argument + " ";
    EXPECT_EQ(complaint_about_failure(result), "") << line;
    EXPECT_NE(result.errors.find(word), std::string::npos) << line << "\n" << result.errors;
    EXPECT_FALSE(std::filesystem::exists(json)) << line;
  }
}

}  // namespace
}  // namespace kiwami_tests
