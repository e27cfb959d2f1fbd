// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <functional>
#include <memory>

#include "kiwami/commands.h"
#include "kiwami/options.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

struct BuildCommandOptions {
  std::string scene;
  std::string output;
  uint32_t load_repeats = 0;
  bool instanced = false;
  TraceOptions trace;
  PipelineOptions pipeline;
};

double milliseconds_of(const std::function<void()>& body) {
  const auto start = std::chrono::steady_clock::now();
  body();
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start;
  return spent.count();
}

/// The median time of a load until a scene is ready to be traced.
double load_time(const Device& device, const BuildCommandOptions& options, uint32_t flags) {
  std::vector<double> times;
  for (uint32_t i = 0; i < options.load_repeats; ++i) {
    std::unique_ptr<BuiltScene> scene;
    times.push_back(milliseconds_of(
        [&] { scene = std::make_unique<BuiltScene>(device, options.output, flags); }));
  }
  std::sort(times.begin(), times.end());
  return times[times.size() / 2];
}

void print_loads(const Device& device, const BuildCommandOptions& options, double build_ms) {
  const struct {
    const char* name;
    uint32_t flags;
  } ways[] = {{"copied, checked", 0},
              {"mapped, checked", KIWAMI_LOAD_MAP},
              {"mapped, trusted", KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED}};
  for (const auto& way : ways) {
    const double ms = load_time(device, options, way.flags);
    std::printf("load    %s: %.2f ms, %.2f %% of the build\n", way.name, ms, 100.0 * ms / build_ms);
  }
}

void run_build(const BuildCommandOptions& options) {
  if (std::filesystem::is_directory(options.output)) {
    throw UsageError("--output is '" + options.output + "', which is a folder, expected a file");
  }
  const Device device = options.trace.make_device();
  const SceneFile loaded = load_scene(options.scene);
  const SceneFile file = options.instanced ? loaded : flatten(loaded);
  const BuiltScene scene(device, file, options.pipeline.build_options(options.trace.bvh_width));
  const kiwami_scene_info& info = scene.info();
  std::printf("build   %s triangles in %.1f ms, %u wide, %.1f bytes per triangle\n",
              grouped(info.triangle_count).c_str(), info.build_seconds * 1e3, info.bvh_width,
              static_cast<double>(info.total_bytes) /
                  static_cast<double>(std::max<uint64_t>(info.triangle_count, 1)));
  uint64_t bytes = 0;
  const double save_ms = milliseconds_of([&] { bytes = scene.save(options.output); });
  std::printf("wrote   %s, %s bytes in %.1f ms\n", options.output.c_str(), grouped(bytes).c_str(),
              save_ms);
  if (options.load_repeats != 0) print_loads(device, options, info.build_seconds * 1e3);
}

}  // namespace

void add_build_command(CLI::App& app, int& exit_code) {
  CLI::App* command =
      app.add_subcommand("build", "Build a scene's tree and save both for the other commands");
  const auto options = std::make_shared<BuildCommandOptions>();
  command->add_option("SCENE", options->scene, "As for render")->required();
  command->add_option("-o,--output", options->output, "The file, by custom a .kiwami")->required();
  command
      ->add_option("--time-loads", options->load_repeats,
                   "Load the file so many times in each way, and print the median")
      ->check(whole_number(0, 1000))
      ->capture_default_str();
  add_instanced_option(*command, options->instanced);
  add_trace_options(*command, options->trace);
  add_pipeline_options(*command, options->pipeline);
  command->callback([options, &exit_code] {
    run_build(*options);
    exit_code = 0;
  });
}

}  // namespace kiwami::tools
