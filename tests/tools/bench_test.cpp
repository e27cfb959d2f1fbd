// SPDX-License-Identifier: Apache-2.0
// `kiwami bench` measures what it is told, and its rows are complete.
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "run_command.h"

namespace kiwami_tests {
namespace {

using Json = nlohmann::json;

const std::vector<std::string> kQuick = {"--ray-count", "2000", "--rounds", "1"};

CommandResult bench(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), "bench");
  arguments.insert(arguments.end(), kQuick.begin(), kQuick.end());
  return run_command(arguments);
}

/// The rows of a bench that must succeed.
Json bench_rows(std::vector<std::string> arguments) {
  const TemporaryFolder folder;
  arguments.insert(arguments.end(), {"--json", folder / "rows.json"});
  const CommandResult result = bench(arguments);
  EXPECT_EQ(result.exit_code, 0) << result.output << result.errors;
  EXPECT_EQ(result.errors, "");
  return Json::parse(read_bytes(folder / "rows.json"), nullptr, false);
}

bool has_embree() {
  return Json::parse(run_command({"info", "--json"}).output).at("embree").get<std::string>() != "";
}

void expect_positive(const Json& row, const std::vector<std::string>& keys) {
  for (const std::string& key : keys) {
    ASSERT_TRUE(row.contains(key)) << key << " of " << row;
    ASSERT_TRUE(row.at(key).is_number()) << key << " of " << row;
    EXPECT_GT(row.at(key).get<double>(), 0.0) << key << " of " << row;
  }
}

TEST(Bench, ExplainsItsOptions) {
  const CommandResult help = run_command({"bench", "--help"});
  EXPECT_EQ(help.exit_code, 0);
  for (const char* option : {"SCENE", "--vs", "--robust", "--embree-quality", "--rays", "--threads",
                             "--api", "--isa", "--bvh-width", "--rounds", "--ray-count", "--param",
                             "--json", "--list", "--scenes", "--eye"}) {
    EXPECT_NE(help.output.find(option), std::string::npos) << option;
  }
}

TEST(Bench, WritesARowForEachBuildAndEachCase) {
  const Json rows = bench_rows({"sphere:3", "--threads", "1", "--vs", "none"});
  ASSERT_TRUE(rows.is_array());
  ASSERT_EQ(rows.size(), 1u + 2 * 6);
  std::set<std::string> cases;
  for (const Json& row : rows) {
    EXPECT_EQ(row.at("scene"), "sphere:3");
    EXPECT_EQ(row.at("triangles"), 1280);
    EXPECT_EQ(row.at("threads"), 1);
    EXPECT_TRUE(row.at("isa").is_string());
    expect_positive(row, {"width"});
    EXPECT_FALSE(row.contains("peer")) << row;
    if (row.contains("build_ms")) {
      expect_positive(row,
                      {"build_ms", "bytes_per_triangle", "peak_bytes_per_triangle", "sah", "epo"});
      EXPECT_GE(row.at("peak_bytes_per_triangle"), row.at("bytes_per_triangle"));
      continue;
    }
    expect_positive(row, {"mrays", "node_visits", "leaf_visits", "leaf_count_variability"});
    EXPECT_EQ(row.at("hits_hash").get<std::string>().size(), 16u);
    const std::string rays = row.at("rays");
    EXPECT_EQ(row.at("any_hit"), rays == "ao" || rays == "shadow");
    cases.insert(row.at("api").get<std::string>() + " " + rays);
  }
  EXPECT_EQ(cases.size(), 12u);
}

TEST(Bench, ComparesWithEmbree) {
  if (!has_embree()) GTEST_SKIP() << "built without Embree";
  const Json rows = bench_rows({"terrain:40", "--threads", "1", "--vs", "embree"});
  ASSERT_EQ(rows.size(), 13u);
  for (const Json& row : rows) {
    EXPECT_TRUE(row.at("peer").get<std::string>().starts_with("Embree 3")) << row;
    if (row.contains("build_ms")) {
      expect_positive(row, {"peer_build_ms", "peer_bytes_per_triangle"});
      continue;
    }
    expect_positive(row, {"peer_mrays", "ratio"});
    const std::string entrance = row.at("peer_entrance");
    const std::string call = row.at("any_hit") ? "rtcOccluded" : "rtcIntersect";
    EXPECT_TRUE(entrance.starts_with(call)) << entrance;
    if (row.at("api") == "single") {
      EXPECT_EQ(entrance, call + "1");
    }
    EXPECT_LT(row.at("peer_disagreements"), 20) << row;
  }
  const Json robust =
      bench_rows({"sphere:2", "--threads", "1", "--vs", "embree", "--robust", "--api", "single"});
  EXPECT_TRUE(robust.at(0).at("peer").get<std::string>().ends_with(" robust"));
  const Json low = bench_rows({"sphere:2", "--threads", "1", "--vs", "embree", "--embree-quality",
                               "low", "--api", "single"});
  EXPECT_TRUE(low.at(0).at("peer").get<std::string>().ends_with(" low"));
}

TEST(Bench, ComparesWithAPlainBinaryHierarchy) {
  const Json rows =
      bench_rows({"terrain:40", "--threads", "1", "--vs", "binary", "--clock", "processor"});
  ASSERT_EQ(rows.size(), 13u);
  for (const Json& row : rows) {
    EXPECT_EQ(row.at("peer"), "binary BVH");
    if (row.contains("build_ms")) {
      expect_positive(row, {"peer_build_ms", "peer_bytes_per_triangle"});
      continue;
    }
    expect_positive(row, {"peer_mrays", "ratio"});
    EXPECT_LT(row.at("peer_disagreements"), 20) << row;
  }
}

TEST(Bench, AnswersTheSameOnEveryIsaWidthAndApi) {
  std::map<std::string, std::set<std::string>> hashes;
  for (const std::string width : {"4", "8", "16"}) {
    for (const std::string isa : {"scalar", "auto"}) {
      for (const Json& row : bench_rows({"room:20000", "--isa", isa, "--bvh-width", width,
                                         "--threads", "1", "--vs", "none"})) {
        EXPECT_EQ(row.at("width").dump(), width);
        if (row.contains("hits_hash")) hashes[row.at("rays")].insert(row.at("hits_hash"));
      }
    }
  }
  EXPECT_EQ(hashes.size(), 6u);
  std::set<std::string> different;
  for (const auto& [rays, of_rays] : hashes) {
    EXPECT_EQ(of_rays.size(), 1u) << rays;
    different.insert(of_rays.begin(), of_rays.end());
  }
  EXPECT_EQ(different.size(), hashes.size());
}

TEST(Bench, MeasuresOnlyWhatItIsTold) {
  const Json rows =
      bench_rows({"sphere:2", "stadium", "--rays", "random,ao", "--api", "batch", "--isa", "scalar",
                  "--threads", "1", "--vs", "none", "--param", "bin_count=8"});
  ASSERT_EQ(rows.size(), 6u);
  EXPECT_EQ(rows.at(1).at("rays"), "random");
  EXPECT_EQ(rows.at(2).at("rays"), "ao");
  EXPECT_EQ(rows.at(3).at("scene"), "stadium");
  for (const Json& row : rows) EXPECT_EQ(row.at("isa"), "scalar");
}

TEST(Bench, ParametersChangeTheTreeAndNotTheAnswers) {
  const std::vector<std::string> common = {"soup:3000:1", "--rays", "random", "--threads", "1",
                                           "--vs",        "none",   "--api",  "batch"};
  std::vector<std::string> leaves_of_one = common;
  leaves_of_one.insert(leaves_of_one.end(), {"--param", "max_leaf_size=1", "--param", "2=0"});
  const Json usual = bench_rows(common);
  const Json changed = bench_rows(leaves_of_one);
  EXPECT_NE(usual.at(0).at("sah"), changed.at(0).at("sah"));
  EXPECT_EQ(usual.at(1).at("hits_hash"), changed.at(1).at("hits_hash"));
}

TEST(Bench, MakesATableOfPipelines) {
  const Json rows = bench_rows({"soup:3000:1", "sphere:2", "--pipelines", "all", "--threads", "1"});
  std::map<std::string, std::set<std::string>> pipelines;
  std::map<std::string, std::set<std::string>> hashes;
  std::set<double> costs;
  for (const Json& row : rows) {
    const std::string scene = row.at("scene");
    EXPECT_TRUE(pipelines[scene].insert(row.at("pipeline")).second) << row;
    expect_positive(
        row, {"triangles", "width", "build_ms_1", "mtris_per_second_1", "bytes_per_triangle",
              "peak_bytes_per_triangle", "sah", "epo", "bounce_shuffled_mrays",
              "bounce_shuffled_ratio", "bounce_shuffled_node_visits", "bounce_shuffled_leaf_visits",
              "ao_mrays", "ao_node_visits"});
    EXPECT_FALSE(row.contains("wrong")) << row;
    for (const std::string rays : {"bounce_shuffled", "ao"}) {
      hashes[scene + rays].insert(row.at(rays + "_hits_hash"));
    }
    if (scene == "soup:3000:1") costs.insert(row.at("sah").get<double>());
  }
  ASSERT_EQ(pipelines.size(), 2u);
  EXPECT_EQ(pipelines["soup:3000:1"], pipelines["sphere:2"]);
  for (const char* name : {"binned_sah, optimal, merged", "binned_sah, surface_area, merged",
                           "lbvh + rotation, optimal, merged", "wide_bottom_up, merged",
                           "wide_top_down + reorder_sato, merged"}) {
    EXPECT_EQ(pipelines["sphere:2"].count(name), 1u) << name;
  }
  for (const auto& [rays, of_rays] : hashes) EXPECT_EQ(of_rays.size(), 1u) << rays;
  EXPECT_GE(costs.size(), 8u);
}

TEST(Bench, APipelineTableIsOfTheBuildersNamed) {
  const Json rows = bench_rows({"sphere:2", "--pipelines", "lbvh,ploc", "--threads", "1",
                                "--builder", "lbvh", "--rays", "random", "--bvh-width", "4"});
  size_t of_lbvh = 0;
  for (const Json& row : rows) {
    const std::string name = row.at("pipeline");
    EXPECT_TRUE(name.starts_with("lbvh") || name.starts_with("ploc")) << name;
    of_lbvh += name.starts_with("lbvh") ? 1 : 0;
    EXPECT_EQ(row.at("width"), 4);
    expect_positive(row, {"random_mrays"});
  }
  // The contractions are tried on --builder alone.
  EXPECT_GT(of_lbvh, rows.size() - of_lbvh);
}

TEST(Bench, APipelineTableNamesSinglePipelines) {
  const Json rows =
      bench_rows({"sphere:2", "--pipelines", "lbvh+none,ploc+rotation", "--contract",
                  "surface_area", "--threads", "1,3", "--clock", "processor", "--rays", "random"});
  std::vector<std::string> names;
  for (const Json& row : rows) {
    names.push_back(row.at("pipeline"));
    expect_positive(row, {"build_ms_1", "build_ms_3"});
  }
  // The last ones are the other contractions of the default builder.
  ASSERT_EQ(names.size(), 4u);
  EXPECT_EQ(names[0], "lbvh, surface_area, merged");
  EXPECT_EQ(names[1], "ploc + rotation, surface_area, merged");
}

TEST(Bench, MakesATableOfTextbookStructures) {
  const Json rows = bench_rows({"stadium", "--structures", "grid,kd_tree,bih,bvh", "--rays",
                                "primary,ao", "--clock", "processor", "--threads", "1"});
  ASSERT_EQ(rows.size(), 5u * 2);
  std::map<std::string, double> tests;
  for (const Json& row : rows) {
    expect_positive(row, {"build_ms", "bytes_per_triangle", "mrays"});
    EXPECT_LT(row.at("disagreements"), 20) << row;
    if (row.at("rays") != "primary") continue;
    const std::string structure = row.at("structure");
    tests[structure] = row.at(structure == "kiwami" ? "leaf_visits" : "triangle_tests");
  }
  ASSERT_EQ(tests.size(), 5u);
  // The teapot lies in a few cells of the grid; whatever adapts to it does not mind.
  EXPECT_GT(tests["grid"], 20.0 * tests["bih"]);
  EXPECT_GT(tests["grid"], 500.0 * tests["kd_tree"]);
  EXPECT_GT(tests["grid"], 500.0 * tests["bvh"]);
}

TEST(Bench, MakesATableOfQueries) {
  for (const std::string limit : {"2", "0"}) {
    const Json rows =
        bench_rows({"room:20000", "--queries", "multi_hit", "--max-hits", limit, "--rays",
                    "primary,random", "--clock", "processor", "--threads", "1"});
    ASSERT_EQ(rows.size(), 2u);
    for (const Json& row : rows) {
      EXPECT_EQ(row.at("query"), "multi_hit");
      EXPECT_EQ(row.at("max_hits").dump(), limit);
      expect_positive(row, {"mrays", "hits_per_ray", "stepping_mrays", "stepping_ratio"});
      EXPECT_LT(row.at("stepping_disagreements"), 20) << row;
      if (row.contains("embree_mrays")) {
        EXPECT_LT(row.at("embree_disagreements"), 20) << row;
      }
    }
    EXPECT_EQ(rows.at(0).at("hits_per_ray") <= 2.0, limit == "2");
  }
}

TEST(Bench, MeasuresFiltersAndMicromaps) {
  const Json rows = bench_rows({"room:20000", "--queries", "filter,micromap", "--rays",
                                "primary,random", "--clock", "processor", "--threads", "1"});
  ASSERT_EQ(rows.size(), 4u);
  for (const Json& row : rows) {
    expect_positive(row, {"mrays", "hits_per_ray"});
    // Where rounding puts a point into another micro-triangle, or a ray on an edge.
    if (row.contains("embree_mrays")) {
      EXPECT_LT(row.at("embree_disagreements"), 20) << row;
    }
  }
}

TEST(Bench, MakesATableOfShapes) {
  const Json rows = bench_rows({"--shapes", "spheres,discs,hair,grains", "--shape-count", "4000",
                                "--rays", "primary,ao", "--clock", "processor", "--threads", "1"});
  ASSERT_EQ(rows.size(), 8u);
  for (const Json& row : rows) {
    expect_positive(row, {"shapes", "hit_part", "mrays"});
    if (row.contains("embree_mrays")) {
      EXPECT_LT(row.at("embree_disagreements"), 20) << row;
    }
  }
  EXPECT_NE(bench({"--shapes", "cubes"}).exit_code, 0);
}

TEST(Bench, TheCameraDecidesThePrimaryRays) {
  const auto hash = [](const std::vector<std::string>& view) {
    std::vector<std::string> arguments = {"terrain:20", "--rays", "primary", "--threads", "1",
                                          "--vs",       "none",   "--api",   "batch"};
    arguments.insert(arguments.end(), view.begin(), view.end());
    return bench_rows(arguments).at(1).at("hits_hash").get<std::string>();
  };
  const std::set<std::string> hashes = {
      hash({}), hash({"--eye", "0,3,1"}), hash({"--eye", "0,3,1", "--target", "0.1,0,0"}),
      hash({"--eye", "0,3,1", "--fov", "20"}), hash({"--eye", "0,3,1", "--up", "1,0,0"})};
  EXPECT_EQ(hashes.size(), 5u);
}

TEST(Bench, EndsWithTheGeometricMeans) {
  if (!has_embree()) GTEST_SKIP() << "built without Embree";
  const CommandResult result = bench({"sphere:2", "--threads", "1"});
  EXPECT_EQ(result.exit_code, 0) << result.errors;
  for (const char* group : {"single, 1 thread ", "batch, 1 thread ", "batch, 1 thread, any hit ",
                            "single, 1 thread, closest hit "}) {
    EXPECT_NE(result.output.find(group), std::string::npos) << group << "\n" << result.output;
  }
}

TEST(Bench, WrongArgumentsAreRefusedInOneSentence) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{}, "SCENE"},
      {{"sphere:1", "--rays", "primary,beams"}, "beams"},
      {{"sphere:1", "--rays", "primary,,ao"}, "--rays"},
      {{"sphere:1", "--rays", "ao,ao"}, "--rays"},
      {{"sphere:1", "--threads", "0"}, "--threads"},
      {{"sphere:1", "--threads", "1,two"}, "two"},
      {{"sphere:1", "--threads", "1000"}, "processors"},
      {{"sphere:1", "--api", "double"}, "double"},
      {{"sphere:1", "--isa", "mmx"}, "mmx"},
      {{"sphere:1", "--bvh-width", "5"}, "--bvh-width"},
      {{"sphere:1", "--vs", "gpu"}, "--vs"},
      {{"sphere:1", "--embree-quality", "best"}, "--embree-quality"},
      {{"sphere:1", "--rounds", "0"}, "--rounds"},
      {{"sphere:1", "--clock", "sun"}, "--clock"},
      {{"sphere:1", "--clock", "processor", "--threads", "2"}, "--clock"},
      {{"sphere:1", "--ray-count", "-5"}, "--ray-count"},
      {{"sphere:1", "--param", "speed=9"}, "speed"},
      {{"sphere:1", "--param", "bin_count"}, "bin_count"},
      {{"sphere:1", "--param", "bin_count=many"}, "many"},
      {{"sphere:1", "--param", "bin_count=100000"}, "100000"},
      {{"sphere:1", "--param", "=3"}, "parameter"},
      {{"sphere:1", "--param", "900=3"}, "900"},
      {{"sphere:1", "--list", "best"}, "best"},
      {{"sphere:1", "--structures", "grid,octree"}, "octree"},
      {{"sphere:1", "--queries", "multi_hit,portal"}, "portal"},
      {{"sphere:1", "--pipelines", "bsp"}, "there is no builder 'bsp'"},
      {{"sphere:1", "--pipelines", "lbvh,lbvh"}, "--pipelines"},
      {{"sphere:1", "--pipelines", "lbvh+magic"}, "magic"},
      {{"sphere:1", "--pipelines", "lbvh", "--clock", "processor", "--threads", "2"}, "--clock"},
      {{"--list", folder / ""}, "expected tuning, judging or a text file"},
      {{"--list", folder.write("empty.txt", "# nothing\n")}, "names no scene"},
      {{"--list", "judging", "--scenes-folder", folder / "none"}, "there is no file"},
      {{"sphere:1", "sphere:2", "--eye", "1,2,3"}, "--eye"},
      {{"sphere:1", "--eye", "1,2"}, "--eye"},
      {{"sphere:1", "--eye", "9,9,9", "--target", "18,18,17"}, "sees nothing"},
      {{"sphere:1", "--json", "/nonexistent-folder/a.json"}, "--json"},
      {{folder / "none.obj"}, "there is no file"},
      {{"hairball:0"}, "N"},
      {{"room:x"}, "N"}};
  for (const auto& [arguments, word] : cases) {
    const CommandResult result = bench(arguments);
    EXPECT_EQ(complaint_about_failure(result), "") << word;
    EXPECT_NE(result.errors.find(word), std::string::npos) << word << "\n" << result.errors;
  }
}

TEST(Bench, KnowsTheScenesOfItsLists) {
  const Json known =
      Json::parse(read_bytes(std::string(KIWAMI_SOURCE_DIR) + "/benchmarks/scenes.json"));
  std::set<std::string> tuning;
  for (const Json& scene : known.at("lists").at("tuning")) tuning.insert(scene);
  for (const Json& scene : known.at("lists").at("judging")) {
    EXPECT_EQ(tuning.count(scene), 0u) << scene << " is judged by and tuned on";
  }
  for (const auto& [name, camera] : known.at("cameras").items()) {
    for (const char* key : {"eye", "target", "up"}) EXPECT_EQ(camera.at(key).size(), 3u) << name;
    expect_positive(camera, {"fov"});
  }
}

TEST(Bench, ReadsAListOfScenesFromAFile) {
  const TemporaryFolder folder;
  const std::string list = folder.write("list.txt", "# quick ones\nsphere:1\n\n  a.obj  # own\n");
  const TemporaryFolder scenes;
  scenes.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  const Json rows = bench_rows({"--list", list, "--scenes", scenes / "", "--rays", "random",
                                "--threads", "1", "--vs", "none", "--api", "batch"});
  ASSERT_EQ(rows.size(), 4u);
  EXPECT_EQ(rows.at(0).at("triangles"), 80);
  EXPECT_EQ(rows.at(2).at("triangles"), 1);
  EXPECT_EQ(rows.at(2).at("scene"), scenes / "a.obj");
}

TEST(Bench, ARowBeginsWithTheSameMembersInTheSameOrder) {
  const TemporaryFolder folder;
  EXPECT_EQ(bench({"sphere:2", "--threads", "1", "--json", folder / "rows.json"}).exit_code, 0);
  const auto rows = nlohmann::ordered_json::parse(read_bytes(folder / "rows.json"));
  std::vector<std::string> builds = {"scene",
                                     "triangles",
                                     "threads",
                                     "isa",
                                     "width",
                                     "build_ms",
                                     "peer",
                                     "peer_build_ms",
                                     "bytes_per_triangle",
                                     "peak_bytes_per_triangle",
                                     "sah"};
  std::vector<std::string> traces = {"scene",   "triangles",  "rays",  "api",
                                     "threads", "isa",        "width", "mrays",
                                     "peer",    "peer_mrays", "ratio", "hits_hash"};
  if (!has_embree()) {
    std::erase_if(builds, [](const std::string& key) { return key.starts_with("peer"); });
    std::erase_if(traces,
                  [](const std::string& key) { return key.starts_with("peer") || key == "ratio"; });
  }
  for (const auto& row : rows) {
    const std::vector<std::string>& expected = row.contains("build_ms") ? builds : traces;
    std::vector<std::string> keys;
    for (const auto& [key, value] : row.items()) keys.push_back(key);
    ASSERT_GE(keys.size(), expected.size());
    keys.resize(expected.size());
    EXPECT_EQ(keys, expected);
  }
}

TEST(Bench, RefitsAndEditsHaveTheirRows) {
  const Json refits = bench_rows({"sphere:4", "--change", "--threads", "1"});
  ASSERT_EQ(refits.size(), 1u);
  EXPECT_GT(refits.at(0).at("refit_ms"), 0.0);
  EXPECT_GT(refits.at(0).at("refitted_sah"), 0.0);
  EXPECT_EQ(refits.at(0).contains("refit_ratio"), has_embree());
  EXPECT_FALSE(refits.at(0).contains("wrong"));
  const Json edits = bench_rows({"sphere:2", "--edit", "50", "--threads", "1"});
  ASSERT_EQ(edits.size(), 1u);
  EXPECT_EQ(edits.at(0).at("objects"), 50);
  EXPECT_GT(edits.at(0).at("build_ms"), 0.0);
  EXPECT_GT(edits.at(0).at("edit_ms"), 0.0);
}

TEST(Bench, APublicSceneHasItsOwnCamera) {
  const std::string path = shared_scene("sponza.tri.gz");
  if (path.empty()) GTEST_SKIP() << "SKIPPED: the shared scenes are absent";
  const TemporaryFolder folder;
  std::filesystem::copy_file(path, folder / "other.tri.gz");
  const std::vector<std::string> common = {"--rays", "primary", "--threads", "1",
                                           "--vs",   "none",    "--api",     "batch"};
  const auto hash = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), common.begin(), common.end());
    return bench_rows(arguments).at(1).at("hits_hash").get<std::string>();
  };
  const std::string known = hash({path});
  EXPECT_NE(known, hash({folder / "other.tri.gz"}));
  EXPECT_EQ(known, hash({folder / "other.tri.gz", "--eye", "-13,3,0", "--target", "10,4.5,0",
                         "--up", "0,1,0", "--fov", "65"}));
}

}  // namespace
}  // namespace kiwami_tests
