// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_lights.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "measure/camera.h"
#include "measure/emissive_lights.h"
#include "measure/ray_sets.h"
#include "scene/random.h"

namespace kiwami::tools {
namespace {

std::vector<const LightMethodName*> parse_methods(const std::string& text, bool is_glossy) {
  std::vector<const LightMethodName*> methods;
  for (const LightMethodName& method : light_methods()) {
    if (text.empty() && (is_glossy || !method.is_glossy())) methods.push_back(&method);
  }
  if (text.empty()) return methods;
  for (const std::string& word : split_words("--light-methods", text)) {
    const LightMethodName* method = find_light_method(word);
    if (!method) {
      throw UsageError("--light-methods has '" + word + "', expected some of " +
                       light_method_list());
    }
    if (method->is_glossy() && !is_glossy) {
      throw UsageError("--light-methods has '" + word +
                       "', which is for glossy receivers, expected --light-roughness above 0");
    }
    methods.push_back(method);
  }
  return methods;
}

std::vector<uint32_t> parse_widths(const std::string& text) {
  std::vector<uint32_t> widths;
  for (const std::string& word : split_words("--light-widths", text)) {
    if (word != "2" && word != "4" && word != "8" && word != "16") {
      throw UsageError("--light-widths has '" + word + "', expected some of 2, 4, 8, 16");
    }
    widths.push_back(static_cast<uint32_t>(std::stoul(word)));
  }
  return widths;
}

bool has_wide_tree(const LightMethodName& method) {
  return method.method != KIWAMI_LIGHT_METHOD_POWER && !method.is_roulette();
}

/// The points that ask for light, and how they reflect it.
struct Receivers {
  std::vector<kiwami_light_receiver> points;
  std::vector<GlossySurface> surfaces;   ///< of each; none where they are diffuse
  std::vector<kiwami_light_lobe> lobes;  ///< of each; none where they are diffuse
  std::vector<kiwami_light_pixel> pixels;
  const BuiltScene* scene = nullptr;  ///< what light is in the shadow of; null: of nothing

  kiwami_ray shadow_ray(const EmissiveTriangle& light, size_t i) const {
    const Vec3 at{points[i].position[0], points[i].position[1], points[i].position[2]};
    // Short of the light, which would be in its own way.
    return make_ray(at, light.middle() - at, 0.0f, 0.999f);
  }

  double contribution(const EmissiveTriangle& light, size_t i) const {
    const kiwami_light_receiver& point = points[i];
    const Vec3 at{point.position[0], point.position[1], point.position[2]};
    const Vec3 from = light.middle();
    if (!surfaces.empty()) {
      return static_cast<double>(light.area * light.sent(from, at) *
                                 surfaces[i].reflected(from - at));
    }
    const Vec3 normal{point.normal[0], point.normal[1], point.normal[2]};
    return static_cast<double>(light.area * light.arriving(from, at, normal));
  }
};

/// One method on one tree, on the same receivers as all others.
class LightRun {
 public:
  LightRun(const LightMethodName& method, const Device& device,
           const std::vector<EmissiveTriangle>& lights, const Receivers& receivers, uint32_t width)
      : method_(method),
        device_(device),
        lights_(lights),
        receivers_(receivers),
        set_(device, lights, width, method.is_roulette()) {}

  /// Estimates what each receiver gets, `draws` calls of the method together: the choices, the
  /// contributions that they ask for, and the shadow rays to them if there are shadows.
  void run(uint32_t draws) {
    std::vector<kiwami_light_receiver> receivers = receivers_.points;
    estimates_.assign(receivers.size(), 0.0);
    choice_count_ = 0;
    std::vector<kiwami_light_choice> choices(receivers.size() * method_.max_choices);
    std::vector<kiwami_light_pixel> pixels = receivers_.pixels;
    Random random(7, 93);
    for (uint32_t draw = 0; draw < draws; ++draw) {
      for (kiwami_light_receiver& receiver : receivers) {
        receiver.random = (static_cast<double>(random.next()) + random.uniform()) * 0x1p-32;
      }
      for (kiwami_light_pixel& pixel : pixels) pixel.sample = draw;
      set_.sample(method_, receivers, {receivers_.lobes, pixels}, choices);
      add_estimates(choices, draws);
    }
  }

  const LightMethodName& method() const { return method_; }
  const Device& device() const { return device_; }
  const kiwami_light_tree_info& info() const { return set_.info(); }
  uint64_t choice_count() const { return choice_count_; }
  const std::vector<double>& estimates() const { return estimates_; }

 private:
  void add_estimates(const std::vector<kiwami_light_choice>& choices, uint32_t draws) {
    rays_.clear();
    sources_.clear();
    amounts_.clear();
    for (size_t i = 0; i < estimates_.size(); ++i) {
      for (uint32_t k = 0; k < method_.max_choices; ++k) {
        const kiwami_light_choice& choice = choices[i * method_.max_choices + k];
        if (choice.light_id == KIWAMI_INVALID_ID) break;
        ++choice_count_;
        const EmissiveTriangle& light = lights_[choice.light_id];
        const double amount =
            receivers_.contribution(light, i) / static_cast<double>(choice.probability) / draws;
        if (!receivers_.scene) {
          estimates_[i] += amount;
        } else if (amount > 0.0) {
          rays_.push_back(receivers_.shadow_ray(light, i));
          sources_.push_back(i);
          amounts_.push_back(amount);
        }
      }
    }
    if (rays_.empty()) return;
    occluded_.resize(rays_.size());
    receivers_.scene->any_hits(rays_, occluded_);
    for (size_t k = 0; k < rays_.size(); ++k) {
      if (occluded_[k] == 0) estimates_[sources_[k]] += amounts_[k];
    }
  }

  const LightMethodName& method_;
  const Device& device_;
  const std::vector<EmissiveTriangle>& lights_;
  const Receivers& receivers_;
  LightSet set_;
  std::vector<double> estimates_;
  uint64_t choice_count_ = 0;
  // Of the shadow rays of one call.
  std::vector<kiwami_ray> rays_;
  std::vector<size_t> sources_;
  std::vector<double> amounts_;
  std::vector<uint8_t> occluded_;
};

class LightBench {
 public:
  LightBench(const std::string& name, const LightBenchOptions& options,
             const BenchSettings& settings)
      : name_(name), options_(options), settings_(settings) {
    const SceneFile file = flatten(load_known_scene(name));
    lights_ = choose_emissive(file, options.share);
    if (lights_.empty()) {
      throw UsageError("no triangle of '" + name + "' shines, expected a larger --light-share");
    }
    device_ = std::make_unique<Device>(settings.isas.front(), 1);
    scene_ = std::make_unique<BuiltScene>(*device_, file, settings.build);
    if (options.has_shadows) receivers_.scene = scene_.get();
    place_receivers(file);
    find_references();
  }

  void run(const std::function<void(const LightRow&)>& on_row) {
    std::vector<std::unique_ptr<Device>> devices;
    std::vector<std::unique_ptr<LightRun>> runs;
    for (const uint32_t isa : settings_.isas) {
      devices.push_back(std::make_unique<Device>(isa, 1));
      for (const LightMethodName* method :
           parse_methods(options_.methods, options_.roughness > 0.0)) {
        for (const uint32_t width : widths_of(*method)) {
          runs.push_back(
              std::make_unique<LightRun>(*method, *devices.back(), lights_, receivers_, width));
        }
      }
    }
    std::vector<Contender> contenders;
    for (const auto& run : runs) {
      LightRun* const each = run.get();
      contenders.push_back({[] {}, [this, each] { each->run(options_.samples); }, [] {}});
    }
    const auto seconds = interleaved_seconds(contenders, settings_.rounds, settings_.clock);
    double power_seconds = 0.0;
    for (size_t i = 0; i < runs.size(); ++i) {
      // Of the same instruction set: the one before in the list.
      if (runs[i]->method().method == KIWAMI_LIGHT_METHOD_POWER) power_seconds = median(seconds[i]);
      on_row(row_of(*runs[i], median(seconds[i]), power_seconds));
    }
  }

 private:
  std::vector<uint32_t> widths_of(const LightMethodName& method) const {
    // One that has no wide tree runs once.
    if (!has_wide_tree(method)) return {4};
    return parse_widths(options_.widths);
  }

  void place_receivers(const SceneFile& file) {
    const auto edge =
        static_cast<uint32_t>(std::ceil(std::sqrt(static_cast<double>(options_.receiver_count))));
    const View view = choose_view(settings_.view, file, bounds_of(scene_->info()), 1.0f);
    const RaySet rays = primary_rays(Camera(view, edge, edge));
    std::vector<kiwami_hit> hits(rays.rays.size());
    scene_->closest_hits(rays.rays, hits);
    for (size_t i = 0; i < hits.size(); ++i) {
      if (!is_hit(hits[i])) continue;
      const Surface surface = surface_of(rays.rays[i], hits[i]);
      receivers_.points.push_back(receiver_at(surface.point, surface.normal, 0.0));
      const auto pixel = static_cast<uint32_t>(i);
      receivers_.pixels.push_back({pixel % edge, pixel / edge, 0});
      if (!(options_.roughness > 0.0)) continue;
      const Vec3 way =
          Vec3{rays.rays[i].direction_x, rays.rays[i].direction_y, rays.rays[i].direction_z};
      receivers_.surfaces.push_back(
          {surface.normal, way * (-1.0f / length(way)), static_cast<float>(options_.roughness)});
      receivers_.lobes.push_back(receivers_.surfaces.back().lobe());
    }
  }

  /// The sum over all lights.
  double reference_of(size_t receiver) const {
    double sum = 0.0;
    std::vector<kiwami_ray> rays;
    std::vector<double> amounts;
    for (const EmissiveTriangle& light : lights_) {
      const double amount = receivers_.contribution(light, receiver);
      if (!receivers_.scene) {
        sum += amount;
      } else if (amount > 0.0) {
        rays.push_back(receivers_.shadow_ray(light, receiver));
        amounts.push_back(amount);
      }
    }
    std::vector<uint8_t> occluded(rays.size());
    if (!rays.empty()) receivers_.scene->any_hits(rays, occluded);
    for (size_t k = 0; k < rays.size(); ++k) sum += occluded[k] == 0 ? amounts[k] : 0.0;
    return sum;
  }

  /// Keeps the receivers that get light at all.
  void find_references() {
    size_t kept = 0;
    for (size_t i = 0; i < receivers_.points.size(); ++i) {
      const double sum = reference_of(i);
      if (!(sum > 0.0)) continue;
      references_.push_back(sum);
      receivers_.points[kept] = receivers_.points[i];
      receivers_.pixels[kept] = receivers_.pixels[i];
      if (!receivers_.surfaces.empty()) {
        receivers_.surfaces[kept] = receivers_.surfaces[i];
        receivers_.lobes[kept] = receivers_.lobes[i];
      }
      ++kept;
    }
    receivers_.points.resize(kept);
    receivers_.pixels.resize(kept);
  }

  LightRow row_of(const LightRun& run, double seconds, double power_seconds) const {
    const auto choices = static_cast<double>(run.choice_count());
    const auto count = static_cast<double>(receivers_.points.size());
    double sum = 0.0;
    for (size_t i = 0; i < receivers_.points.size(); ++i) {
      const double relative = run.estimates()[i] / references_[i] - 1.0;
      sum += relative * relative;
    }
    // Errors of means go with the number of choices.
    const double wanted = static_cast<double>(options_.samples) * count;
    const double error = sum / count * choices / wanted;
    const double seconds_wanted = seconds * wanted / choices;
    const kiwami_light_tree_info& info = run.info();
    return {name_,
            lights_.size(),
            receivers_.points.size(),
            run.method().name,
            kiwami_isa_name(run.device().info().isa),
            has_wide_tree(run.method()) ? info.width : 0,
            info.build_seconds * 1e3,
            static_cast<double>(info.bytes) / static_cast<double>(lights_.size()),
            choices / seconds * 1e-6,
            choices / count / options_.samples,
            error,
            power_seconds > 0.0 ? error * seconds_wanted / power_seconds : 0.0};
  }

  std::string name_;
  const LightBenchOptions& options_;
  const BenchSettings& settings_;
  std::unique_ptr<Device> device_;
  std::unique_ptr<BuiltScene> scene_;
  std::vector<EmissiveTriangle> lights_;
  Receivers receivers_;
  std::vector<double> references_;  ///< by receiver
};

}  // namespace

void run_lights(const std::string& scene, const LightBenchOptions& options,
                const BenchSettings& settings, const std::function<void(const LightRow&)>& on_row) {
  parse_methods(options.methods, options.roughness > 0.0);
  parse_widths(options.widths);
  LightBench(scene, options, settings).run(on_row);
}

nlohmann::ordered_json to_json(const LightRow& row) {
  return {{"scene", row.scene},
          {"lights", row.lights},
          {"receivers", row.receivers},
          {"method", row.method},
          {"isa", row.isa},
          {"width", row.width},
          {"build_ms", row.build_milliseconds},
          {"bytes_per_light", row.bytes_per_light},
          {"mega_choices_per_second", row.mega_choices},
          {"choices_per_receiver", row.choices_per_receiver},
          {"mse", row.error},
          {"mse_equal_time", row.error_equal_time}};
}

void print_row(const LightRow& row, bool is_first) {
  if (is_first) {
    std::printf("%s: %s lights, %zu receivers\n", row.scene.c_str(), grouped(row.lights).c_str(),
                row.receivers);
    std::printf("%-16s %-7s %5s %9s %8s %10s %8s %11s %11s\n", "method", "isa", "width", "build ms",
                "B/light", "Mchoices/s", "choices", "error", "equal time");
  }
  std::printf("%-16s %-7s %5u %9.1f %8.1f %10.3f %8.2f %11.4g %11.4g\n", row.method.c_str(),
              row.isa.c_str(), row.width, row.build_milliseconds, row.bytes_per_light,
              row.mega_choices, row.choices_per_receiver, row.error, row.error_equal_time);
}

}  // namespace kiwami::tools
