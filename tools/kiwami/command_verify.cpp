// SPDX-License-Identifier: Apache-2.0
#include <cstdio>
#include <memory>

#include "kiwami/commands.h"
#include "kiwami/options.h"
#include "kiwami/verifier.h"

namespace kiwami::tools {
namespace {

struct VerifyOptions {
  std::string scene;
  uint64_t rays = 20000;
  uint64_t seed = 1;
  bool instanced = false;
  PipelineOptions pipeline;
};

constexpr int kDifferenceFound = 1;

bool is_verified(const VerifyOptions& options, const SceneFile& world, const SceneFile& file) {
  if (file.left_out_count != 0) {
    return Verifier(world, file, options.scene, options.rays, options.seed).run();
  }
  return Verifier(world, options.instanced ? file : world, options.pipeline.build_options(0),
                  options.rays, options.seed)
      .run();
}

int run_verify(const VerifyOptions& options) {
  const SceneFile file = load_scene(options.scene, OtherGeometries::kLeftOut);
  const SceneFile world = flatten(file);
  std::printf("%s: %s triangles%s, seed %llu\n", options.scene.c_str(),
              grouped(world.triangle_count()).c_str(), left_out_text(file).c_str(),
              static_cast<unsigned long long>(options.seed));
  const bool equal = is_verified(options, world, file);
  std::printf("\n%s\n", equal ? "verified" : "NOT VERIFIED");
  return equal ? 0 : kDifferenceFound;
}

}  // namespace

void add_verify_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "verify", "Compare every ISA, node width and thread count, bit for bit, and Embree");
  const auto options = std::make_shared<VerifyOptions>();
  command->add_option("SCENE", options->scene, "As for render")->required();
  command->add_option("--rays", options->rays, "Rays of each kind")
      ->check(whole_number(1, 100000000))
      ->capture_default_str();
  command->add_option("--seed", options->seed, "Seed of the random rays")
      ->check(whole_number(0, UINT64_MAX))
      ->capture_default_str();
  add_instanced_option(*command, options->instanced);
  add_pipeline_options(*command, options->pipeline);
  command->footer(
      "Exits with 1 at the first difference, after saying which ray it is. A .kiwami file with "
      "shapes or motion is loaded as it was built, or built anew for another width by its own "
      "parameters, and Embree is not asked.");
  command->callback([options, &exit_code] { exit_code = run_verify(*options); });
}

}  // namespace kiwami::tools
