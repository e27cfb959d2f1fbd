// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <memory>

#include "kiwami/commands.h"
#include "kiwami/demo_table.h"
#include "kiwami/image.h"
#include "kiwami/options.h"
#include "kiwami/renderer.h"

namespace kiwami::tools {
namespace {

struct DemoOptions {
  std::vector<std::string> scenes;
  std::string output;
  std::string json;
  uint32_t rounds = 5;
  uint32_t samples_per_pixel = 16;
};

constexpr Size kPictureSize = {640, 480};
constexpr int kDifferenceFound = 1;

Image render_with(uint32_t isa, const SceneFile& file, uint32_t samples_per_pixel) {
  const Device device(isa, 0);
  const BuiltScene scene(device, file);
  const Box box = bounds_of(scene.info());
  const float aspect =
      static_cast<float>(kPictureSize.width) / static_cast<float>(kPictureSize.height);
  const View view = default_view(file, box, aspect);
  RenderSettings settings;
  settings.samples_per_pixel = samples_per_pixel;
  settings.up = view.up;
  settings.threads = device.info().thread_count;
  Tracing tracing(scene);
  return render(tracing, Camera(view, kPictureSize.width, kPictureSize.height), settings,
                [](uint64_t, uint64_t) {});
}

/// Renders the scene with every ISA; the pictures must be equal.
bool render_all(const SceneFile& file, uint32_t samples_per_pixel, Image& picture) {
  std::string equal;
  for (const uint32_t isa : available_isas()) {
    Image image = render_with(isa, file, samples_per_pixel);
    if (!equal.empty() && image.pixels != picture.pixels) {
      std::printf("the picture of %s differs from that of %s\n", kiwami_isa_name(isa),
                  equal.c_str());
      return false;
    }
    picture = std::move(image);
    equal += (equal.empty() ? "" : ", ") + std::string(kiwami_isa_name(isa));
  }
  std::printf("pictures equal: %s\n", equal.c_str());
  return true;
}

int run_demo(const DemoOptions& options) {
  if (!options.output.empty()) check_image_path("--output", options.output);
  if (!options.json.empty()) check_writable("--json", options.json);
  bool equal = true;
  std::vector<Image> pictures;
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  for (const std::string& name : options.scenes) {
    const SceneFile file = flatten(load_scene(name));
    DemoSettings settings;
    settings.rounds = options.rounds;
    const DemoTable table = measure_demo(name, file, settings);
    print_demo(table);
    report.push_back(demo_to_json(table));
    equal = equal && std::all_of(table.rows.begin(), table.rows.end(),
                                 [](const DemoRow& row) { return row.equal_bits; });
    if (options.output.empty()) continue;
    pictures.emplace_back();
    equal = render_all(file, options.samples_per_pixel, pictures.back()) && equal;
  }
  if (!options.output.empty()) {
    write_image(side_by_side(pictures), options.output);
    std::printf("wrote %s\n", options.output.c_str());
  }
  if (!options.json.empty()) write_file(options.json, report.dump(2) + "\n");
  return equal ? 0 : kDifferenceFound;
}

}  // namespace

void add_demo_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand(
      "demo", "Measure scenes with every ISA and node width, next to Embree, and render them");
  const auto options = std::make_shared<DemoOptions>();
  command->add_option("SCENE", options->scenes, "One or more scenes, as for render")->required();
  command->add_option("-o,--output", options->output,
                      "A .png or .ppm file: the scenes side by side");
  command->add_option("--json", options->json, "Write the tables to this file, too");
  command->add_option("--rounds", options->rounds, "Runs of each; their median counts")
      ->check(whole_number(1, 1000))
      ->capture_default_str();
  command->add_option("--spp", options->samples_per_pixel, "Samples a pixel of the picture")
      ->check(whole_number(1, 65536))
      ->capture_default_str();
  command->footer("Exits with 1 when an answer is not equal to the scalar one, bit for bit.");
  command->callback([options, &exit_code] { exit_code = run_demo(*options); });
}

}  // namespace kiwami::tools
