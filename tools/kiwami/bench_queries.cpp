// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_queries.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/own_run.h"
#include "measure/bench_rays.h"
#include "measure/contest.h"
#include "measure/embree_queries.h"
#include "measure/leaf_mask.h"

namespace kiwami::tools {
namespace {

/// Closest hits again and again, each beyond the last: of several hits at one distance it finds one
/// alone.
void step_hits(const BuiltScene& scene, std::span<const kiwami_ray> rays, uint32_t max_hits,
               std::vector<std::vector<kiwami_hit>>& lists) {
  std::vector<kiwami_ray> under_way(rays.begin(), rays.end());
  std::vector<size_t> numbers(rays.size());
  std::vector<kiwami_hit> hits(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) numbers[i] = i;
  for (std::vector<kiwami_hit>& list : lists) list.clear();
  for (uint32_t step = 0; (max_hits == 0 || step < max_hits) && !under_way.empty(); ++step) {
    hits.resize(under_way.size());
    scene.closest_hits(under_way, hits);
    size_t left = 0;
    for (size_t i = 0; i < under_way.size(); ++i) {
      if (hits[i].primitive_id == KIWAMI_INVALID_ID) continue;
      lists[numbers[i]].push_back(hits[i]);
      under_way[left] = under_way[i];
      numbers[left] = numbers[i];
      under_way[left].tmin = std::nextafter(hits[i].t, std::numeric_limits<float>::infinity());
      if (under_way[left].tmin <= under_way[left].tmax) ++left;
    }
    under_way.resize(left);
  }
}

/// One scene, with the rivals of its queries.
class QueryBench {
 public:
  QueryBench(const std::string& name, const BenchSettings& settings)
      : name_(name),
        settings_(settings),
        file_(load_known_scene(name)),
        device_(settings.isas.front(), 1),
        scene_(device_, file_, settings.build) {
    if (settings.peer == BenchPeer::kEmbree) {
      embree_ = EmbreeQueries::create(file_, device_.info().isa);
    }
    const Box box = bounds_of(scene_.info());
    least_distance_ = 1e-6f * box.diagonal();
    rays_ = make_bench_rays(scene_, choose_view(settings.view, file_, box, 1.0f), box,
                            settings.rays, settings.ray_count);
  }

  const std::vector<BenchRays>& rays() const { return rays_; }

  QueryRow multi_hit(const BenchRays& rays, uint32_t max_hits) const;
  /// A filter that lets every other triangle go.
  QueryRow filter(const BenchRays& rays) const;
  /// Leaves in place of all triangles: micromaps here, a filter that reads the same map there.
  QueryRow micromap(const BenchRays& rays);

 private:
  QueryRow closest_row(const BenchRays& rays, const char* query,
                       const std::function<void(std::span<kiwami_hit>)>& trace, AcceptsHit accepts,
                       const void* user) const;

  template <typename OwnHits, typename TheirHits>
  bool agree(const OwnHits& own, const TheirHits& theirs) const {
    if (own.size() != theirs.size()) return false;
    for (size_t i = 0; i < own.size(); ++i) {
      const float a = own[i].t, b = theirs[i].t;
      if (std::abs(a - b) > 1e-3f * std::min(a, b) + least_distance_) return false;
    }
    return true;
  }

  QueryRow row_of(const BenchRays& rays, const char* query) const {
    const kiwami_scene_info& info = scene_.info();
    return {name_,
            info.triangle_count,
            kiwami_isa_name(device_.info().isa),
            info.bvh_width,
            query,
            rays.set.name,
            0,
            0.0,
            0.0,
            {},
            ""};
  }

  std::string name_;
  const BenchSettings& settings_;
  SceneFile file_;
  Device device_;
  BuiltScene scene_;
  std::unique_ptr<BuiltScene> masked_;  ///< with leaves
  std::unique_ptr<EmbreeQueries> embree_;
  std::vector<BenchRays> rays_;
  float least_distance_ = 0.0f;
};

/// Fills in the times of the row's contenders: its own, and those of its rivals in their order.
void take_times(QueryRow& row, const std::vector<std::vector<double>>& seconds, size_t ray_count) {
  const double millions = static_cast<double>(ray_count) * 1e-6;
  row.mrays = millions / median(seconds[0]);
  for (size_t rival = 0; rival < row.rivals.size(); ++rival) {
    const std::vector<double>& theirs = seconds[rival + 1];
    std::vector<double> ratios;
    for (size_t i = 0; i < theirs.size(); ++i) ratios.push_back(theirs[i] / seconds[0][i]);
    row.rivals[rival].mrays = millions / median(theirs);
    row.rivals[rival].ratio = median(ratios);
  }
}

QueryRow QueryBench::multi_hit(const BenchRays& rays, uint32_t max_hits) const {
  const std::span<const kiwami_ray> all = rays.set.rays;
  HitLists own{std::vector<uint64_t>(all.size() + 1), {}};
  own.hits.resize(scene_.multi_hits(all, max_hits, own.offsets, {}));
  std::vector<std::vector<kiwami_hit>> stepped(all.size());
  HitLists collected;
  std::vector<Contender> contenders = {
      {[&] { std::fill(own.hits.begin(), own.hits.end(), kiwami_hit{}); },
       [&] { scene_.multi_hits(all, max_hits, own.offsets, own.hits); }, [] {}},
      {[] {}, [&] { step_hits(scene_, all, max_hits, stepped); }, [] {}}};
  QueryRow row = row_of(rays, "multi_hit");
  row.max_hits = max_hits;
  row.hits = static_cast<double>(own.hits.size()) / static_cast<double>(all.size());
  row.rivals = {{"stepping", 0.0, 0.0, 0}};
  if (embree_) {
    contenders.push_back({[] {}, [&] { embree_->multi_hits(all, max_hits, collected); }, [] {}});
    row.rivals.push_back({"Embree", 0.0, 0.0, 0});
  }
  for (const Contender& contender : contenders) contender.run();
  take_times(row, interleaved_seconds(contenders, settings_.rounds, settings_.clock), all.size());
  const auto list = [](const HitLists& lists, size_t i) {
    return std::span(lists.hits).subspan(lists.offsets[i], lists.offsets[i + 1] - lists.offsets[i]);
  };
  for (size_t i = 0; i < all.size(); ++i) {
    row.rivals[0].disagreements += !agree(list(own, i), stepped[i]);
    if (embree_) row.rivals[1].disagreements += !agree(list(own, i), list(collected, i));
  }
  const QueryRival& judge = row.rivals.back();
  if (static_cast<double>(judge.disagreements) >
      kMostDisagreements * static_cast<double>(all.size())) {
    row.wrong = format("%llu of %zu answers contradict those of %s",
                       static_cast<unsigned long long>(judge.disagreements), all.size(),
                       judge.name.c_str());
  }
  return row;
}

/// Closest hits under a condition, which Embree checks by a filter.
QueryRow QueryBench::closest_row(const BenchRays& rays, const char* query,
                                 const std::function<void(std::span<kiwami_hit>)>& trace,
                                 AcceptsHit accepts, const void* user) const {
  const std::span<const kiwami_ray> all = rays.set.rays;
  std::vector<kiwami_hit> own(all.size());
  std::vector<float> theirs(all.size());
  std::vector<Contender> contenders = {{[] {}, [&] { trace(own); }, [] {}}};
  QueryRow row = row_of(rays, query);
  row.max_hits = 1;
  if (embree_) {
    contenders.push_back(
        {[] {}, [&] { embree_->filtered_hits(all, accepts, user, theirs); }, [] {}});
    row.rivals = {{"Embree", 0.0, 0.0, 0}};
  }
  for (const Contender& contender : contenders) contender.run();
  take_times(row, interleaved_seconds(contenders, settings_.rounds, settings_.clock), all.size());
  uint64_t hits = 0;
  for (size_t i = 0; i < all.size(); ++i) {
    hits += own[i].primitive_id != KIWAMI_INVALID_ID;
    if (!embree_) continue;
    const float a = own[i].t, b = theirs[i];
    const bool agree = a == b || std::abs(a - b) <= 1e-3f * std::min(a, b) + least_distance_;
    row.rivals[0].disagreements += !agree;
  }
  row.hits = static_cast<double>(hits) / static_cast<double>(all.size());
  if (embree_ && static_cast<double>(row.rivals[0].disagreements) >
                     kMostDisagreements * static_cast<double>(all.size())) {
    row.wrong = format("%llu of %zu answers contradict those of Embree",
                       static_cast<unsigned long long>(row.rivals[0].disagreements), all.size());
  }
  return row;
}

bool is_kept(uint32_t primitive_id) { return (primitive_id & 1u) == 0; }
bool accept_kept(uint32_t, uint32_t primitive_id, float, float, const void*) {
  return is_kept(primitive_id);
}
int32_t filter_kept(void*, const kiwami_filter_candidate* candidate) {
  return is_kept(candidate->hit.primitive_id) ? KIWAMI_FILTER_ACCEPT : KIWAMI_FILTER_REJECT;
}

QueryRow QueryBench::filter(const BenchRays& rays) const {
  const auto trace = [&](std::span<kiwami_hit> hits) {
    scene_.filtered_hits(rays.set.rays, filter_kept, nullptr, hits);
  };
  return closest_row(rays, "filter", trace, accept_kept, nullptr);
}

constexpr uint32_t kLeafLevel = 5;

bool accept_leaf(uint32_t, uint32_t, float u, float v, const void* user) {
  const auto* const map = static_cast<const unsigned char*>(user);
  const uint32_t number = kiwami_opacity_micro_triangle(u, v, kLeafLevel);
  return ((map[number / 8] >> (number % 8)) & 1u) != 0;
}

QueryRow QueryBench::micromap(const BenchRays& rays) {
  if (!masked_) {
    BuildOptions options = settings_.build;
    options.leaf_mask_level = kLeafLevel;
    masked_ = std::make_unique<BuiltScene>(device_, file_, options);
  }
  const std::vector<unsigned char> map = leaf_map(kLeafLevel);
  const auto trace = [&](std::span<kiwami_hit> hits) {
    masked_->closest_hits(rays.set.rays, hits);
  };
  return closest_row(rays, "micromap", trace, accept_leaf, map.data());
}

}  // namespace

const std::vector<std::string>& query_names() {
  static const std::vector<std::string> kNames = {"multi_hit", "filter", "micromap"};
  return kNames;
}

void run_queries(const std::string& scene, const std::vector<std::string>& names, uint32_t max_hits,
                 const BenchSettings& settings,
                 const std::function<void(const QueryRow&)>& listener) {
  QueryBench bench(scene, settings);
  for (const std::string& name : names) {
    for (const BenchRays& rays : bench.rays()) {
      if (name == "multi_hit") listener(bench.multi_hit(rays, max_hits));
      if (name == "filter") listener(bench.filter(rays));
      if (name == "micromap") listener(bench.micromap(rays));
    }
  }
}

nlohmann::ordered_json to_json(const QueryRow& row) {
  nlohmann::ordered_json json;
  json["scene"] = row.scene;
  json["triangles"] = row.triangles;
  json["isa"] = row.isa;
  json["width"] = row.width;
  json["query"] = row.query;
  json["rays"] = row.rays;
  json["max_hits"] = row.max_hits;
  json["hits_per_ray"] = row.hits;
  json["mrays"] = row.mrays;
  for (const QueryRival& rival : row.rivals) {
    const std::string name = rival.name == "Embree" ? "embree" : rival.name;
    json[name + "_mrays"] = rival.mrays;
    json[name + "_ratio"] = rival.ratio;
    json[name + "_disagreements"] = rival.disagreements;
  }
  return json;
}

void print_row(const QueryRow& row, bool is_first) {
  if (is_first) {
    std::printf("\n%s: %s triangles; %s, %u wide, one thread\n", row.scene.c_str(),
                grouped(row.triangles).c_str(), row.isa.c_str(), row.width);
  }
  std::printf("  %-10s %-15s %7.2f hits %9.3f Mrays/s", row.query.c_str(), row.rays.c_str(),
              row.hits, row.mrays);
  for (const QueryRival& rival : row.rivals) {
    std::printf("  %6.2f x %s (%.3f, %llu differ)", rival.ratio, rival.name.c_str(), rival.mrays,
                static_cast<unsigned long long>(rival.disagreements));
  }
  std::printf("\n");
  if (!row.wrong.empty()) std::printf("  WRONG: %s\n", row.wrong.c_str());
  std::fflush(stdout);
}

}  // namespace kiwami::tools
