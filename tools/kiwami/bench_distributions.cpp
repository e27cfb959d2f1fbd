// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_distributions.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "measure/emissive_lights.h"
#include "scene/random.h"

namespace kiwami::tools {
namespace {

/// One way to draw numbers: it is built again and again, and asked for draws.
class Drawer {
 public:
  virtual ~Drawer() = default;
  virtual const char* name() const = 0;
  virtual void build() = 0;
  virtual void draw(const std::vector<double>& randoms, std::vector<kiwami_draw>& draws) const = 0;
  virtual kiwami_distribution_info info() const = 0;
};

class LibraryDrawer : public Drawer {
 public:
  LibraryDrawer(const char* name, uint32_t method, const std::vector<float>& weights)
      : name_(name), device_(KIWAMI_ISA_AUTO, 1), weights_(weights), method_(method) {}
  ~LibraryDrawer() override { kiwami_distribution_release(distribution_); }

  const char* name() const override { return name_; }
  void build() override {
    kiwami_distribution_release(distribution_);
    kiwami_distribution_desc desc;
    throw_on_error(kiwami_distribution_desc_init(&desc, sizeof desc));
    desc.method = method_;
    desc.weights = weights_.data();
    desc.weight_count = weights_.size();
    throw_on_error(kiwami_distribution_create(device_.get(), &desc, &distribution_));
  }
  void draw(const std::vector<double>& randoms, std::vector<kiwami_draw>& draws) const override {
    throw_on_error(kiwami_distribution_sample(distribution_, randoms.data(), 0, draws.data(), 0,
                                              randoms.size()));
  }
  kiwami_distribution_info info() const override {
    kiwami_distribution_info info;
    info.struct_size = sizeof info;
    throw_on_error(kiwami_distribution_get_info(distribution_, &info));
    return info;
  }

 private:
  const char* name_;
  Device device_;
  const std::vector<float>& weights_;
  uint32_t method_;
  kiwami_distribution* distribution_ = nullptr;
};

/// What the others replace: a binary search in the cumulative sums.
class SearchDrawer : public Drawer {
 public:
  explicit SearchDrawer(const std::vector<float>& weights) : weights_(weights) {}

  const char* name() const override { return "binary_search"; }
  void build() override {
    bounds_.resize(weights_.size());
    total_ = 0.0;
    for (size_t i = 0; i < weights_.size(); ++i) {
      bounds_[i] = total_;
      total_ += static_cast<double>(weights_[i]);
    }
    for (double& bound : bounds_) bound /= total_;
  }
  void draw(const std::vector<double>& randoms, std::vector<kiwami_draw>& draws) const override {
    for (size_t i = 0; i < randoms.size(); ++i) {
      const auto after = std::upper_bound(bounds_.begin(), bounds_.end(), randoms[i]);
      const double upper = after == bounds_.end() ? 1.0 : *after;
      const double lower = after[-1];
      draws[i].index = static_cast<uint32_t>(after - bounds_.begin() - 1);
      draws[i].probability = static_cast<float>(upper - lower);
      draws[i].random = std::min((randoms[i] - lower) / (upper - lower), 1.0 - 0x1p-53);
    }
  }
  kiwami_distribution_info info() const override {
    kiwami_distribution_info info{};
    info.weight_count = weights_.size();
    info.bytes = weights_.size() * sizeof(double);
    info.total = total_;
    info.most_steps = static_cast<uint32_t>(std::bit_width(weights_.size()));
    info.mean_steps = std::log2(static_cast<double>(weights_.size()) + 1.0);
    return info;
  }

 private:
  const std::vector<float>& weights_;
  std::vector<double> bounds_;
  double total_ = 0.0;
};

/// Van der Corput's sequence in base 2: each stretch of it is spread evenly over [0, 1).
double van_der_corput(uint32_t number) {
  uint64_t reversed = 0;
  for (int bit = 0; bit < 32; ++bit) reversed |= uint64_t{(number >> bit) & 1u} << (31 - bit);
  return static_cast<double>(reversed) * 0x1p-32;
}

std::vector<float> areas_of(const std::string& scene) {
  std::vector<float> areas;
  for (const EmissiveTriangle& triangle : choose_emissive(flatten(load_known_scene(scene)), 1.0)) {
    areas.push_back(triangle.area);
  }
  if (areas.empty()) throw UsageError("no triangle of '" + scene + "' has an area, expected some");
  return areas;
}

/// Mean of |drawn - expected| over the numbers, in units of the draws that each is due on average.
double unevenness_of(const Drawer& drawer, const std::vector<float>& weights, double total) {
  constexpr uint32_t kDrawsOfEach = 16;
  std::vector<double> randoms(kDrawsOfEach * weights.size());
  for (size_t i = 0; i < randoms.size(); ++i) randoms[i] = van_der_corput(static_cast<uint32_t>(i));
  std::vector<kiwami_draw> draws(randoms.size());
  drawer.draw(randoms, draws);
  std::vector<uint32_t> counts(weights.size());
  for (const kiwami_draw& draw : draws) ++counts[draw.index];
  double sum = 0.0;
  for (size_t i = 0; i < weights.size(); ++i) {
    const double expected =
        static_cast<double>(weights[i]) / total * static_cast<double>(randoms.size());
    sum += std::fabs(counts[i] - expected);
  }
  return sum / static_cast<double>(randoms.size());
}

/// Whether the draws can be those of the weights: all have one, and the order is kept where it is
/// promised.
std::string fault_of(const std::vector<kiwami_draw>& draws,
                     const std::vector<kiwami_draw>& expected, const std::vector<float>& weights,
                     bool keeps_order) {
  for (size_t i = 0; i < draws.size(); ++i) {
    if (draws[i].index >= weights.size() || !(weights[draws[i].index] > 0.0f)) {
      return "draw " + std::to_string(i) + " is of no weight";
    }
    if (keeps_order && draws[i].index != expected[i].index) {
      return "draw " + std::to_string(i) + " is not the binary search's";
    }
  }
  return {};
}

std::string hash_of(const std::vector<kiwami_draw>& draws) {
  return format("%016llx",
                static_cast<unsigned long long>(hash_bytes(std::as_bytes(std::span(draws)))));
}

std::vector<double> ratios(const std::vector<double>& seconds,
                           const std::vector<double>& of_search) {
  std::vector<double> result;
  for (size_t i = 0; i < seconds.size(); ++i) result.push_back(of_search[i] / seconds[i]);
  return result;
}

}  // namespace

std::vector<DistributionRow> run_distributions(const std::string& scene,
                                               const BenchSettings& settings) {
  const std::vector<float> weights = areas_of(scene);
  std::vector<std::unique_ptr<Drawer>> drawers;
  drawers.push_back(std::make_unique<SearchDrawer>(weights));
  drawers.push_back(std::make_unique<LibraryDrawer>(
      "radix_tree_forest", KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST, weights));
  drawers.push_back(
      std::make_unique<LibraryDrawer>("alias_table", KIWAMI_DISTRIBUTION_ALIAS_TABLE, weights));
  Random random(7, 94);
  std::vector<double> randoms(settings.ray_count);
  for (double& number : randoms) {
    number = (static_cast<double>(random.next()) + static_cast<double>(random.uniform())) * 0x1p-32;
  }
  std::vector<std::vector<kiwami_draw>> draws(drawers.size(),
                                              std::vector<kiwami_draw>(randoms.size()));
  std::vector<std::string> hashes(drawers.size()), wrong(drawers.size());
  std::vector<Contender> builders, contenders;
  for (size_t i = 0; i < drawers.size(); ++i) {
    builders.push_back({[] {}, [&, i] { drawers[i]->build(); }, [] {}});
    contenders.push_back({[] {}, [&, i] { drawers[i]->draw(randoms, draws[i]); },
                          [&, i] {
                            const std::string hash = hash_of(draws[i]);
                            if (!hashes[i].empty() && hash != hashes[i]) {
                              wrong[i] = "draws differ between rounds";
                            }
                            hashes[i] = hash;
                          }});
  }
  const auto build_seconds = interleaved_seconds(builders, settings.rounds, settings.clock);
  const auto seconds = interleaved_seconds(contenders, settings.rounds, settings.clock);
  std::vector<DistributionRow> rows;
  for (size_t i = 0; i < drawers.size(); ++i) {
    const kiwami_distribution_info info = drawers[i]->info();
    const bool keeps_order = i == 1;
    if (wrong[i].empty()) wrong[i] = fault_of(draws[i], draws[0], weights, keeps_order);
    rows.push_back({scene, weights.size(), drawers[i]->name(), median(build_seconds[i]) * 1e3,
                    static_cast<double>(info.bytes) / static_cast<double>(weights.size()),
                    info.mean_steps, info.most_steps,
                    static_cast<double>(randoms.size()) / median(seconds[i]) * 1e-6,
                    median(ratios(seconds[i], seconds[0])),
                    unevenness_of(*drawers[i], weights, info.total), hashes[i], wrong[i]});
  }
  return rows;
}

nlohmann::ordered_json to_json(const DistributionRow& row) {
  return {{"scene", row.scene},
          {"weights", row.weights},
          {"method", row.method},
          {"build_ms", row.build_milliseconds},
          {"bytes_per_weight", row.bytes_per_weight},
          {"mean_steps", row.mean_steps},
          {"most_steps", row.most_steps},
          {"mega_draws_per_second", row.mega_draws},
          {"ratio", row.ratio},
          {"unevenness", row.unevenness},
          {"draws_hash", row.draws_hash},
          {"wrong", row.wrong}};
}

void print_table(const std::vector<DistributionRow>& rows) {
  std::printf("%s: %s triangles by area\n", rows.front().scene.c_str(),
              grouped(rows.front().weights).c_str());
  std::printf("%-18s %9s %9s %11s %5s %9s %7s %11s\n", "method", "build ms", "B/weight",
              "mean steps", "most", "Mdraws/s", "ratio", "unevenness");
  for (const DistributionRow& row : rows) {
    std::printf("%-18s %9.1f %9.1f %11.2f %5u %9.2f %7.2f %11.4f %s\n", row.method.c_str(),
                row.build_milliseconds, row.bytes_per_weight, row.mean_steps, row.most_steps,
                row.mega_draws, row.ratio, row.unevenness, row.wrong.c_str());
  }
}

}  // namespace kiwami::tools
