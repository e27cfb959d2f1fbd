// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>
#include <numeric>

#include "kiwami/commands.h"
#include "kiwami/image.h"
#include "kiwami/inspect_report.h"
#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/view_options.h"
#include "measure/bench_rays.h"
#include "measure/node_visits.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

constexpr uint64_t kMostShapeTriangles = 6000;

struct InspectOptions {
  std::string scene;
  std::string html;
  std::string json;
  std::vector<std::string> pipelines;
  std::vector<std::string> parameters;
  std::string rays = "random";
  uint64_t ray_count = 16384;
  bool overlap = true;
  uint64_t most_rows = 10000;
  ViewOptions view;
  TraceOptions trace;
};

/// The builds of all pipelines; mistakes in them are found before the scene is read.
std::vector<BuildOptions> make_builds(const InspectOptions& options) {
  std::vector<BuildOptions> builds;
  for (const std::string& text : options.pipelines) {
    builds.push_back(parse_pipeline("--pipeline", text, options.trace.bvh_width));
  }
  if (builds.empty()) builds.push_back(PipelineOptions().build_options(options.trace.bvh_width));
  for (BuildOptions& build : builds) {
    for (const std::string& text : options.parameters) {
      build.parameters.push_back(parse_parameter(text));
    }
  }
  return builds;
}

void check_options(const InspectOptions& options) {
  if (options.html.empty() && options.json.empty()) {
    throw UsageError("nothing is to be written, expected --html or --json");
  }
  if (!options.html.empty() && !has_inspect_page()) {
    throw UsageError(
        "--html: this build has no page, which npm bundles when the command is built; --json "
        "works");
  }
  const std::vector<std::string>& known = bench_ray_names();
  if (options.rays != "none" &&
      std::find(known.begin(), known.end(), options.rays) == known.end()) {
    std::string names;
    for (const std::string& name : known) names += name + ", ";
    throw UsageError("--rays is '" + options.rays + "', expected " + names + "or none");
  }
  check_view_options(options.view);
  if (!options.html.empty()) check_writable("--html", options.html);
  if (!options.json.empty()) check_writable("--json", options.json);
}

InspectedTree inspect_tree(const BuiltScene& scene, const BuildOptions& build,
                           const std::vector<kiwami_ray>& rays, const InspectOptions& options) {
  MeasuredTree measured = scene.measured_tree(options.overlap ? 0 : KIWAMI_MEASURE_WITHOUT_EPO);
  InspectedTree tree;
  tree.build = build;
  tree.info = scene.info();
  tree.node_count = measured.nodes.size();
  tree.sah = measured.total.sah;
  if (options.overlap) tree.epo = measured.total.epo;
  NodeFigures figures{std::move(measured.measures), {}};
  if (!rays.empty()) {
    figures.visits = node_visits(measured.nodes, scene, rays);
    const auto visits = std::accumulate(figures.visits.begin(), figures.visits.end(), uint64_t{0});
    tree.visits_per_ray = static_cast<double>(visits) / static_cast<double>(rays.size());
  }
  tree.rows = summarize(measured.nodes, figures, options.most_rows);
  return tree;
}

void print_tree(const InspectedTree& tree) {
  std::printf("tree    %s: %s nodes, depth %u, SAH %.3f", pipeline_name(tree.build).c_str(),
              grouped(tree.node_count).c_str(), tree.info.bvh_depth, tree.sah);
  if (tree.epo) std::printf(", EPO %.3f", *tree.epo);
  if (tree.visits_per_ray) std::printf(", %.2f visits a ray", *tree.visits_per_ray);
  std::printf("; %s rows\n", grouped(tree.rows.size()).c_str());
}

Inspection inspect(const InspectOptions& options, const std::vector<BuildOptions>& builds) {
  const Device device = options.trace.make_device();
  const SceneFile file = load_known_scene(options.scene, false, OtherGeometries::kLeftOut);
  if (file.triangle_count() == 0) {
    throw SceneError("'" + options.scene + "' holds no triangles at rest, whose tree is shown");
  }
  if (file.left_out_count != 0) {
    std::printf("note    %s geometries that are shapes or move are left out\n",
                grouped(file.left_out_count).c_str());
  }
  Inspection inspection;
  inspection.scene = std::filesystem::path(options.scene).filename().string();
  std::vector<kiwami_ray> rays;
  for (const BuildOptions& build : builds) {
    const BuiltScene scene(device, file, build);
    if (inspection.trees.empty()) {
      const Box box = bounds_of(scene.info());
      const View view = choose_view(options.view, file, box, 1.0f);
      inspection.scene_info = scene.info();
      inspection.up = view.up;
      if (options.rays != "none") {
        rays = make_bench_rays(scene, view, box, {options.rays}, options.ray_count)[0].set.rays;
      }
    }
    inspection.trees.push_back(inspect_tree(scene, build, rays, options));
    print_tree(inspection.trees.back());
  }
  inspection.rays = options.rays;
  inspection.ray_count = rays.size();
  inspection.shape = coarse_shape(file, kMostShapeTriangles);
  return inspection;
}

void run_inspect(const InspectOptions& options) {
  check_options(options);
  const std::vector<BuildOptions> builds = make_builds(options);
  const std::string json = to_json_text(inspect(options, builds));
  if (!options.json.empty()) {
    write_file(options.json, json + "\n");
    std::printf("wrote   %s\n", options.json.c_str());
  }
  if (!options.html.empty()) {
    write_file(options.html, make_inspect_page(json));
    std::printf("wrote   %s\n", options.html.c_str());
  }
}

void add_inspect_options(CLI::App& command, InspectOptions& options) {
  command
      .add_option(
          "SCENE", options.scene,
          "An .obj, .tri or .ins file, each also with .gz, or one of " + procedural_scene_names())
      ->required();
  command.add_option("--html", options.html,
                     "Write a page with charts of the trees to this file; it needs no network");
  command.add_option("--json", options.json, "Write the same data as JSON to this file");
  command
      .add_option("--pipeline", options.pipelines,
                  "How a tree is built, as BUILDER[+OPTIMIZER]...[,CONTRACTION][,merged|unmerged];"
                  " may be repeated, to compare")
      ->expected(1)
      ->take_all();
  command
      .add_option("--param", options.parameters,
                  "A parameter of all builds as NAME=VALUE, such as bin_count=16; may be repeated")
      ->expected(1)
      ->take_all();
  command
      .add_option("--rays", options.rays,
                  "Which rays visits are counted of: one of the sets of bench, or none")
      ->capture_default_str();
  command.add_option("--ray-count", options.ray_count, "How many of them")
      ->check(whole_number(1, uint64_t{1} << 24))
      ->capture_default_str();
  command.add_flag("--overlap,!--no-overlap", options.overlap,
                   "Measure the end-point overlap (the default), which takes longer than the rest");
  command
      .add_option("--nodes", options.most_rows,
                  "Nodes of a tree that are shown one by one, at most; those of little cost are "
                  "joined")
      ->check(whole_number(1, uint64_t{1} << 30))
      ->capture_default_str();
  add_view_options(command, options.view);
  add_trace_options(command, options.trace);
}

}  // namespace

void add_inspect_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("inspect", "Look into the trees of a scene");
  const auto options = std::make_shared<InspectOptions>();
  add_inspect_options(*command, *options);
  command->callback([options, &exit_code] {
    run_inspect(*options);
    exit_code = 0;
  });
}

}  // namespace kiwami::tools
