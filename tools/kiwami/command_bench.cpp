// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <cstdio>
#include <memory>
#include <optional>
#include <thread>

#include "kiwami/bench.h"
#include "kiwami/bench_options.h"
#include "kiwami/bench_queries.h"
#include "kiwami/bench_report.h"
#include "kiwami/bench_tables.h"
#include "kiwami/commands.h"
#include "kiwami/image.h"
#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/progress.h"
#include "measure/bench_rays.h"
#include "measure/emissive_lights.h"
#include "scene/procedural.h"
#include "scene/shape_clouds.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kMostThreads = 1024;
constexpr char kAllRays[] = "primary,bounce,bounce_shuffled,ao,shadow,random";
constexpr char kPipelineRays[] = "bounce_shuffled,ao";

std::vector<uint32_t> parse_threads(const std::string& text) {
  std::vector<uint32_t> threads;
  for (const std::string& word : split_different_words("--threads", text)) {
    uint32_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size() || number < 1 ||
        number > kMostThreads) {
      throw UsageError("--threads has '" + word + "', expected whole numbers of 1 to " +
                       std::to_string(kMostThreads));
    }
    threads.push_back(number);
  }
  return threads;
}

std::vector<BenchApi> parse_apis(const std::string& text) {
  std::vector<BenchApi> apis;
  for (const std::string& word : split_different_words("--api", text)) {
    if (word != "single" && word != "batch") {
      throw UsageError("--api has '" + word + "', expected single, batch or both");
    }
    apis.push_back(word == "single" ? BenchApi::kSingle : BenchApi::kBatch);
  }
  return apis;
}

EmbreeQuality parse_embree_quality(const std::string& text) {
  if (text == "low") return EmbreeQuality::kLow;
  return text == "high" ? EmbreeQuality::kHigh : EmbreeQuality::kDefault;
}

BenchSettings make_settings(const BenchOptions& options) {
  BenchSettings settings;
  const char* usual_rays = options.pipelines.empty() ? kAllRays : kPipelineRays;
  settings.rays = split_known_words("--rays", options.rays.empty() ? usual_rays : options.rays,
                                    bench_ray_names());
  settings.threads = parse_threads(options.threads);
  settings.apis = parse_apis(options.apis);
  for (const std::string& isa : split_different_words("--isa", options.isas)) {
    settings.isas.push_back(isa_of_name(isa));
  }
  settings.instanced = options.instanced;
  settings.motion = options.motion;
  settings.build = options.pipeline.build_options(options.bvh_width);
  for (const std::string& text : options.parameters) {
    settings.build.parameters.push_back(parse_parameter(text));
  }
  check_view_options(options.view);
  settings.view = options.view;
  settings.peer = options.peer == "embree"   ? BenchPeer::kEmbree
                  : options.peer == "binary" ? BenchPeer::kBinary
                                             : BenchPeer::kNone;
  if (settings.peer == BenchPeer::kEmbree && *embree_version() == '\0') {
    throw UsageError("--vs is embree, but this command was built without Embree");
  }
  settings.robust = options.robust;
  settings.embree_quality = parse_embree_quality(options.embree_quality);
  settings.rounds = options.rounds;
  settings.ray_count = options.ray_count;
  settings.clock = options.clock == "wall" ? Clock::kWall : Clock::kProcessor;
  const bool also_more_threads = !options.pipelines.empty() && settings.threads.front() == 1;
  if (settings.clock == Clock::kProcessor && settings.threads != std::vector<uint32_t>{1} &&
      !also_more_threads) {
    throw UsageError(
        "--clock is processor, which is for --threads 1, alone or as the first with --pipelines");
  }
  return settings;
}

std::vector<std::string> choose_scenes(const BenchOptions& options) {
  std::vector<std::string> scenes = options.scenes;
  if (!options.list.empty()) {
    const std::vector<std::string> listed = scenes_of_list(options.list, options.scenes_folder);
    scenes.insert(scenes.end(), listed.begin(), listed.end());
  }
  if (scenes.empty()) throw UsageError("no scene is given, expected some SCENE or --list");
  if (scenes.size() > 1 && !options.view.empty()) {
    throw UsageError("--eye, --target, --up and --fov are for one scene, but there are " +
                     std::to_string(scenes.size()));
  }
  return scenes;
}

int run(const BenchOptions& options) {
  const BenchSettings settings = make_settings(options);
  if (!options.json.empty()) check_writable("--json", options.json);
  if (!options.shapes.empty()) return run_shape_table(options, settings);
  if (options.tetrahedra != 0) return run_tetrahedron_table(options, settings);
  const std::vector<std::string> scenes = choose_scenes(options);
  if (options.instanced &&
      (options.peer == "binary" || !options.pipelines.empty() || !options.structures.empty())) {
    throw UsageError(
        "--instanced goes with --vs embree or none, and with neither --pipelines nor --structures");
  }
  if (!options.motion.empty() && (options.peer == "binary" || options.asks_for_table())) {
    throw UsageError("--motion is for the table of rays, with --vs embree or none");
  }
  if (const std::optional<int> exit_code = run_table(options, settings, scenes)) return *exit_code;
  const std::string peer = peer_name(settings);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  RatioSummary summary;
  bool all_right = true;
  uint64_t traced = 0;
  uint64_t done = 0;
  Progress bar(scenes.size() * trace_row_count(settings));
  BenchListener listener;
  listener.on_build = [&](const BuildRow& row) {
    bar.clear();
    print_row(row, peer);
    rows.push_back(to_json(row, peer));
  };
  listener.on_trace = [&](const TraceRow& row) {
    bar.clear();
    print_row(row);
    rows.push_back(to_json(row, peer));
    summary.add(row);
    all_right = all_right && row.wrong.empty();
    bar.update(++done, traced);
  };
  listener.on_round = [&](uint64_t rays) { bar.update(done, traced += rays); };
  for (const std::string& scene : scenes) {
    run_bench(scene, settings, listener);
    // After each scene, so that a long run that is stopped has not been in vain.
    if (!options.json.empty()) write_file(options.json, rows.dump(1) + "\n");
  }
  bar.clear();
  summary.print(peer);
  return all_right ? 0 : kWrongAnswer;
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  const auto check = [words](std::string& text) -> std::string {
    if (std::find(words.begin(), words.end(), text) != words.end()) return {};
    return "it is '" + text + "', expected one of " + joined_words(words);
  };
  return CLI::Validator(check, "");
}

void add_scene_options(CLI::App& command, BenchOptions& options) {
  command.add_option("SCENE", options.scenes,
                     "One or more .obj, .tri or .ins files, each also with .gz, or some of " +
                         procedural_scene_names());
  command.add_option("--list", options.list,
                     "All scenes of a list: " + joined_words(scene_list_names()) +
                         ", or a text file with a scene a line");
  command
      .add_option("--scenes-folder,--scenes", options.scenes_folder,
                  "Where the files of the list are")
      ->capture_default_str();
  add_instanced_option(command, options.instanced);
  add_motion_option(command, options.motion);
  add_view_options(command, options.view);
}

void add_light_options(CLI::App& command, LightBenchOptions& options) {
  command.add_flag("--lights", options.is_asked,
                   "A table of ways to choose among many lights in place of rays: a part of the "
                   "scene's triangles shines");
  command.add_option("--light-methods", options.methods,
                     "Some of " + light_method_list() + ", between commas; by default all");
  command.add_option("--light-widths", options.widths, "Children a node of trees over lights")
      ->capture_default_str();
  command.add_option("--light-share", options.share, "The part of the triangles that shines")
      ->check(finite_number(0.0, 1.0))
      ->capture_default_str();
  command
      .add_option("--light-samples", options.samples,
                  "Choices a receiver at which errors are compared")
      ->check(whole_number(1, 65536))
      ->capture_default_str();
  command.add_option("--light-receivers", options.receiver_count, "Points that the camera sees")
      ->check(whole_number(1, 1u << 24))
      ->capture_default_str();
  command.add_flag("--light-shadows", options.has_shadows,
                   "A shadow ray for each choice, which counts in the time");
  command
      .add_option("--light-roughness", options.roughness,
                  "Receivers are glossy: alpha of their GGX distribution; 0: they are diffuse")
      ->check(finite_number(0.0, 1.0))
      ->capture_default_str();
}

void add_measuring_options(CLI::App& command, BenchOptions& options) {
  command
      .add_option("--vs", options.peer,
                  "Who traces the same rays: embree, binary (a plain hierarchy without vectors) or "
                  "none")
      ->check(one_of({"embree", "binary", "none"}))
      ->capture_default_str();
  command.add_flag("--robust", options.robust, "Embree with its robust scene flag");
  command
      .add_option("--embree-quality", options.embree_quality,
                  "The quality of Embree's build: low, default or high")
      ->check(one_of({"low", "default", "high"}))
      ->capture_default_str();
  command.add_option("--rays", options.rays,
                     std::string("Which ray sets, between commas: by default ") + kAllRays +
                         "; with --pipelines " + kPipelineRays);
  command.add_option("--threads", options.threads, "Numbers of threads, between commas")
      ->capture_default_str();
  command
      .add_option("--api", options.apis,
                  "single: one ray a call; batch: all in one, against Embree's best entrance")
      ->capture_default_str();
  command
      .add_option("--isa", options.isas,
                  "Instruction sets between commas: auto, scalar, sse, avx2, avx512")
      ->capture_default_str();
  command.add_option("--bvh-width", options.bvh_width, "Children a node; 0: the device's default")
      ->check(one_of({"0", "4", "8", "16"}))
      ->capture_default_str();
  add_pipeline_options(command, options.pipeline);
  command.add_option("--pipelines", options.pipelines,
                     "A table of pipelines in place of a peer: these builders between commas, or "
                     "all, each alone and with each optimiser; BUILDER+OPTIMIZER or BUILDER+none "
                     "is that one alone");
  command.add_option("--structures", options.structures,
                     "A table of textbook structures in place of a peer, some of grid, kd_tree, "
                     "bih and bvh, next to the library, one ray a call on one thread");
  command.add_flag("--binary-layouts", options.binary_layouts,
                   "A table of the layouts of a binary tree by --builder, with boxes and as a "
                   "dual-split tree: closest hits, one ray after the other on one thread");
  command.add_flag("--change", options.change,
                   "Refits of the scene with moving vertices, in place of rays");
  command.add_flag("--distributions", options.distributions,
                   "Triangles drawn by their areas, --ray-count of them on one thread, by each "
                   "kind of discrete distribution, in place of rays");
  command
      .add_option("--tetrahedra", options.tetrahedra,
                  "Points, --ray-count of them on one thread, located in a mesh of so many cubes "
                  "along each side with six tetrahedra each; no SCENE is needed")
      ->check(whole_number(1, 300));
  command.add_option("--queries", options.queries,
                     "A table of queries on one thread, some of " + joined_words(query_names()) +
                         ", next to what they replace: stepping from hit to hit, and Embree's "
                         "filter functions");
  command.add_option("--max-hits", options.max_hits, "Hits of a ray in --queries; 0: all")
      ->capture_default_str();
  command
      .add_option("--edit", options.edit,
                  "Commits of so many copies of the scene, a tree for each, when one has moved, in "
                  "place of rays")
      ->check(whole_number(1, 1000000));
  command.add_option("--shapes", options.shapes,
                     "A table of generated scenes on one thread, in place of a scene: some of " +
                         joined_words(cloud_names()) + ", next to Embree's own points and curves");
  command.add_option("--shape-count", options.shape_count, "How many shapes --shapes generates")
      ->check(whole_number(16, 1 << 26))
      ->capture_default_str();
  command.add_option("--rounds", options.rounds, "Runs of each side; their medians count")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  command.add_option("--ray-count", options.ray_count, "Rays of a set")
      ->check(whole_number(1, uint64_t{1} << 28))
      ->capture_default_str();
  command
      .add_option(
          "--clock", options.clock,
          "wall: the time that passes; processor: the time spent on a processor, for one "
          "thread on a machine that is busy with other work; with --pipelines, more threads "
          "are imagined, which share the tasks of a build")
      ->check(one_of({"wall", "processor"}))
      ->capture_default_str();
  command
      .add_option("--param", options.parameters,
                  "A parameter of the build as NAME=VALUE, such as bin_count=16; may be repeated")
      ->expected(1)
      ->take_all();
  command.add_option("--json", options.json, "Write all rows to this file, too");
}

}  // namespace

void add_bench_command(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("bench", "Measure builds and rays next to Embree, on the same rays");
  const auto options = std::make_shared<BenchOptions>();
  add_scene_options(*command, *options);
  add_measuring_options(*command, *options);
  add_light_options(*command, options->lights);
  command->footer("Exits with 1 when answers differ between rounds, instruction sets or threads.");
  command->callback([options, &exit_code] { exit_code = run(*options); });
}

}  // namespace kiwami::tools
