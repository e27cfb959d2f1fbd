// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <memory>
#include <tuple>
#include <utility>

#include "kiwami/commands.h"
#include "kiwami/direct_light.h"
#include "kiwami/image.h"
#include "kiwami/options.h"
#include "kiwami/progress.h"
#include "kiwami/renderer.h"
#include "kiwami/view_options.h"
#include "measure/camera.h"
#include "scene/kiwami_reader.h"
#include "scene/motion.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

struct RenderOptions {
  std::string scene;
  std::string output;
  std::string mode = "path";
  std::string size = "1024x768";
  uint32_t samples_per_pixel = 16;
  uint32_t bounces = 4;
  bool instanced = false;
  std::string lights;  ///< how they are chosen; empty: no lights
  double light_share = 0.1;
  double light_roughness = 0.0;
  ViewOptions view;
  TraceOptions trace;
  PipelineOptions pipeline;
  uint32_t leaf_mask_level = 0;
  std::string motion;  ///< empty: everything rests
  std::string shutter = "0,1";
};

RenderMode parse_mode(const std::string& name) {
  if (name == "normals") return RenderMode::kNormals;
  if (name == "ao") return RenderMode::kAmbientOcclusion;
  if (name == "path") return RenderMode::kPath;
  throw UsageError("--mode is '" + name + "', expected normals, ao or path");
}

/// When the shutter opens and when it closes.
std::pair<float, float> parse_shutter(const std::string& text) {
  const std::vector<std::string> words = split_words("--shutter", text);
  float times[2] = {0.0f, -1.0f};
  for (size_t i = 0; i < std::min<size_t>(words.size(), 2); ++i) {
    const char* const end = words[i].data() + words[i].size();
    const auto [stop, error] = std::from_chars(words[i].data(), end, times[i]);
    if (error != std::errc() || stop != end) times[1] = -1.0f;
  }
  if (words.size() != 2 || !(0.0f <= times[0] && times[0] <= times[1] && times[1] <= 1.0f)) {
    throw UsageError("--shutter is '" + text + "', expected two times from 0 to 1 that rise");
  }
  return {times[0], times[1]};
}

/// Syntax errors of options that need the scene are found before the scene is read.
void check_options(const RenderOptions& options) {
  parse_mode(options.mode);
  parse_size("--size", options.size);
  if (!options.lights.empty() && !find_light_method(options.lights)) {
    throw UsageError("--lights is '" + options.lights + "', expected " + light_method_list());
  }
  if (!options.lights.empty() && find_light_method(options.lights)->is_glossy() &&
      !(options.light_roughness > 0.0)) {
    throw UsageError("--lights is '" + options.lights +
                     "', which is for glossy surfaces, expected --light-roughness above 0");
  }
  if (!options.lights.empty() && options.instanced) {
    throw UsageError("--lights goes without --instanced");
  }
  if (!options.motion.empty() && (!options.lights.empty() || options.leaf_mask_level != 0)) {
    throw UsageError("--motion goes with neither --lights nor --leaf-mask");
  }
  parse_shutter(options.shutter);
  check_view_options(options.view);
  check_image_path("--output", options.output);
}

void print_build(const SceneFile& file, const Device& device, const kiwami_scene_info& info) {
  const std::string instances =
      file.instances.empty() ? "" : ", " + grouped(file.instances.size()) + " instances";
  std::printf("scene   %s triangles in %s meshes%s%s\n", grouped(file.triangle_count()).c_str(),
              grouped(file.meshes.size()).c_str(), instances.c_str(), left_out_text(file).c_str());
  if (info.skipped_count > 0) {
    std::printf("note    %s triangles are skipped: a vertex is NaN, infinite or beyond 2^60\n",
                grouped(info.skipped_count).c_str());
  }
  std::printf("device  %s, %u wide, %u threads\n", kiwami_isa_name(device.info().isa),
              info.bvh_width, device.info().thread_count);
  std::printf("build   %.1f ms, %.1f bytes per triangle, nodes %.1f %% and leaves %.1f %% full\n",
              info.build_seconds * 1e3,
              static_cast<double>(info.total_bytes) /
                  static_cast<double>(std::max<uint64_t>(info.triangle_count, 1)),
              info.node_fill * 100.0, info.leaf_fill * 100.0);
}

/// With the trees of the file, if it is one that was saved with them and stays as it is. Lights ask
/// for more: that hits are named as in the loaded file.
std::unique_ptr<BuiltScene> make_scene(const RenderOptions& options, const Device& device,
                                       const SceneFile& loaded, const SceneFile& file) {
  const bool is_changed = !options.motion.empty() || options.leaf_mask_level != 0;
  const bool has_names = options.lights.empty() || loaded.has_saved_numbers;
  if (is_saved_scene(options.scene) && has_names && !is_changed) {
    return std::make_unique<BuiltScene>(device, options.scene, KIWAMI_LOAD_MAP, &loaded);
  }
  BuildOptions build = options.pipeline.build_options(options.trace.bvh_width);
  build.leaf_mask_level = options.leaf_mask_level;
  return std::make_unique<BuiltScene>(device, file, build);
}

/// The lights that are asked for, or null.
std::unique_ptr<DirectLight> make_light(const RenderOptions& options, const Device& device,
                                        const SceneFile& file) {
  if (options.lights.empty()) return nullptr;
  auto light = std::make_unique<DirectLight>(device, file, options.light_share,
                                             *find_light_method(options.lights),
                                             options.trace.bvh_width, options.light_roughness);
  const kiwami_light_tree_info& info = light->set().info();
  std::printf("lights  %s emissive triangles, tree of %.1f ms, %u wide, %.1f bytes per light\n",
              grouped(info.light_count).c_str(), info.build_seconds * 1e3, info.width,
              static_cast<double>(info.bytes) / std::max(info.light_count, 1u));
  return light;
}

void run_render(const RenderOptions& options) {
  check_options(options);
  const Size size = parse_size("--size", options.size);
  const Device device = options.trace.make_device();
  const bool needs_triangles =
      !options.lights.empty() || !options.motion.empty() || options.leaf_mask_level != 0;
  const SceneFile loaded = load_scene(
      options.scene, needs_triangles ? OtherGeometries::kRefused : OtherGeometries::kLeftOut);
  SceneFile file = options.instanced ? loaded : flatten(loaded);
  if (!options.motion.empty()) set_in_motion(file, options.motion);
  const std::unique_ptr<BuiltScene> built = make_scene(options, device, loaded, file);
  const BuiltScene& scene = *built;
  print_build(file, device, scene.info());

  const Box box = bounds_of(scene.info());
  const float aspect = static_cast<float>(size.width) / static_cast<float>(size.height);
  const View view = choose_view(options.view, file, box, aspect);
  RenderSettings settings;
  settings.mode = parse_mode(options.mode);
  settings.samples_per_pixel = options.samples_per_pixel;
  settings.bounces = options.bounces;
  settings.occlusion_radius = 0.1f * box.diagonal();
  settings.up = view.up;
  settings.threads = device.info().thread_count;
  if (!options.motion.empty() || loaded.left_out_count != 0) {
    std::tie(settings.shutter_open, settings.shutter_close) = parse_shutter(options.shutter);
  }
  Tracing tracing(scene);
  const std::unique_ptr<DirectLight> light = make_light(options, device, file);
  if (light) {
    light->expose(tracing, Camera(view, 64, 64 * size.height / size.width + 1));
    settings.mode = RenderMode::kDirectLight;
    settings.direct_light = light.get();
  }
  const auto start = std::chrono::steady_clock::now();
  Image image;
  {
    Progress bar(uint64_t{size.width} * size.height * options.samples_per_pixel);
    image = render(tracing, Camera(view, size.width, size.height), settings,
                   [&](uint64_t samples, uint64_t rays) { bar.update(samples, rays); });
  }
  const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
  write_image(image, options.output);
  std::printf("render  %.2f s, %s rays, %.2f Mrays/s while tracing\n", spent.count(),
              grouped(tracing.ray_count()).c_str(),
              static_cast<double>(tracing.ray_count()) / tracing.seconds() * 1e-6);
  std::printf("wrote   %s\n", options.output.c_str());
}

}  // namespace

void add_render_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("render", "Render a picture of a scene");
  const auto options = std::make_shared<RenderOptions>();
  command
      ->add_option("SCENE", options->scene,
                   "An .obj, .tri or .ins file, each also with .gz, a .kiwami file, whose tree is "
                   "taken as it "
                   "was built, or one of " +
                       procedural_scene_names())
      ->required();
  command->add_option("-o,--output", options->output, "The picture: a .png or .ppm file")
      ->required();
  command->add_option("--mode", options->mode, "normals, ao (ambient occlusion) or path")
      ->capture_default_str();
  command->add_option("--size", options->size, "Width and height of the picture")
      ->capture_default_str();
  command->add_option("--spp", options->samples_per_pixel, "Samples a pixel")
      ->check(whole_number(1, 65536))
      ->capture_default_str();
  command->add_option("--bounces", options->bounces, "Bounces of a path")
      ->check(whole_number(1, 8))
      ->capture_default_str();
  add_instanced_option(*command, options->instanced);
  command
      ->add_option("--leaf-mask", options->leaf_mask_level,
                   "Put a leaf in place of each triangle, by opacity micromaps of this level, 1 to "
                   "6; 0: none")
      ->check(whole_number(0, 6))
      ->capture_default_str();
  command->add_option(
      "--lights", options->lights,
      "Light from a part of the scene's triangles, which shine, in place of --mode, "
      "one bounce, chosen by " +
          light_method_list());
  command
      ->add_option("--light-share", options->light_share, "The part of the triangles that shines")
      ->check(finite_number(0.0, 1.0))
      ->capture_default_str();
  command
      ->add_option("--light-roughness", options->light_roughness,
                   "Surfaces are glossy: alpha of their GGX distribution; 0: they are diffuse")
      ->check(finite_number(0.0, 1.0))
      ->capture_default_str();
  add_motion_option(*command, options->motion);
  command
      ->add_option("--shutter", options->shutter,
                   "Where something moves: when the shutter opens and closes, from 0 to 1")
      ->capture_default_str();
  add_view_options(*command, options->view);
  add_trace_options(*command, options->trace);
  add_pipeline_options(*command, options->pipeline);
  command->callback([options, &exit_code] {
    run_render(*options);
    exit_code = 0;
  });
}

}  // namespace kiwami::tools
