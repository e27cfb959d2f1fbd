// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_shapes.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "kiwami/options.h"
#include "measure/bench_rays.h"
#include "measure/contest.h"
#include "measure/shape_scene.h"

namespace kiwami::tools {
namespace {

/// Grazing rays may be decided otherwise in single precision.
constexpr double kMostShapeDisagreements = 0.01;

class ShapeBench {
 public:
  ShapeBench(const std::string& name, uint32_t count, const BenchSettings& settings)
      : name_(name),
        settings_(settings),
        cloud_(make_cloud(name, count)),
        device_(settings.isas.front(), 1),
        scene_(device_, cloud_) {
    if (settings.peer == BenchPeer::kEmbree) {
      embree_ = EmbreeShapes::create(cloud_, device_.info().isa);
    }
    const Box box = bounds_of(scene_.info());
    least_distance_ = 1e-5f * box.diagonal();
    const View view = fit_view(box, {0.0f, 1.0f, 0.0f}, kDefaultFieldOfView, 1.0f);
    rays_ = make_bench_rays(scene_, view, box, settings.rays, settings.ray_count);
  }

  const std::vector<BenchRays>& rays() const { return rays_; }

  ShapeRow trace(const BenchRays& rays) const {
    const std::span<const kiwami_ray> all = rays.set.rays;
    Answers own(all.size()), theirs(all.size());
    std::vector<Contender> contenders = {
        {[&] { own.reset(); }, [&] { ask(scene_, rays, own); }, [] {}}};
    if (embree_) {
      contenders.push_back({[&] { theirs.reset(); }, [&] { ask(*embree_, rays, theirs); }, [] {}});
    }
    const auto seconds = interleaved_seconds(contenders, settings_.rounds, settings_.clock);
    const double millions = static_cast<double>(all.size()) * 1e-6;
    ShapeRow row{name_,
                 cloud_.count(),
                 kiwami_isa_name(device_.info().isa),
                 scene_.info().bvh_width,
                 rays.set.name,
                 scene_.info().build_seconds * 1e3,
                 own.hit_part(rays.any_hit),
                 millions / median(seconds[0]),
                 {},
                 ""};
    if (embree_) compare(row, own, theirs, seconds, rays.any_hit);
    return row;
  }

 private:
  struct Answers {
    std::vector<kiwami_hit> hits;
    std::vector<uint8_t> occluded;

    explicit Answers(size_t count) : hits(count), occluded(count) {}
    void reset() {
      std::fill(hits.begin(), hits.end(), kiwami_hit{});
      std::fill(occluded.begin(), occluded.end(), uint8_t{2});
    }
    double hit_part(bool any_hit) const {
      const auto count = any_hit
                             ? std::count(occluded.begin(), occluded.end(), 1)
                             : std::count_if(hits.begin(), hits.end(), [](const kiwami_hit& hit) {
                                 return hit.primitive_id != KIWAMI_INVALID_ID;
                               });
      return static_cast<double>(count) / static_cast<double>(hits.size());
    }
  };

  template <typename Scene>
  static void ask(const Scene& scene, const BenchRays& rays, Answers& answers) {
    if (rays.any_hit) {
      scene.any_hits(rays.set.rays, answers.occluded);
    } else {
      scene.closest_hits(rays.set.rays, answers.hits);
    }
  }

  void compare(ShapeRow& row, const Answers& own, const Answers& theirs,
               const std::vector<std::vector<double>>& seconds, bool any_hit) const {
    PeerTrace peer{any_hit ? "rtcOccluded1" : "rtcIntersect1", 0.0, 0.0, 0};
    std::vector<double> ratios;
    for (size_t i = 0; i < seconds[0].size(); ++i) ratios.push_back(seconds[1][i] / seconds[0][i]);
    peer.ratio = median(ratios);
    peer.mrays = static_cast<double>(own.hits.size()) * 1e-6 / median(seconds[1]);
    for (size_t i = 0; i < own.hits.size(); ++i) {
      const float a = own.hits[i].t, b = theirs.hits[i].t;
      const bool agree =
          any_hit ? own.occluded[i] == theirs.occluded[i]
                  : a == b || std::fabs(a - b) <= 1e-3f * std::min(a, b) + least_distance_;
      if (!agree) ++peer.disagreements;
    }
    if (static_cast<double>(peer.disagreements) >
        kMostShapeDisagreements * static_cast<double>(own.hits.size())) {
      row.wrong = format("%llu of %zu answers contradict those of Embree",
                         static_cast<unsigned long long>(peer.disagreements), own.hits.size());
    }
    row.peer = peer;
  }

  std::string name_;
  const BenchSettings& settings_;
  ShapeCloud cloud_;
  Device device_;
  ShapeScene scene_;
  std::unique_ptr<EmbreeShapes> embree_;
  std::vector<BenchRays> rays_;
  float least_distance_ = 0.0f;
};

}  // namespace

void run_shapes(const std::string& cloud, uint32_t count, const BenchSettings& settings,
                const std::function<void(const ShapeRow&)>& listener) {
  const ShapeBench bench(cloud, count, settings);
  for (const BenchRays& rays : bench.rays()) listener(bench.trace(rays));
}

nlohmann::ordered_json to_json(const ShapeRow& row) {
  nlohmann::ordered_json json;
  json["scene"] = row.scene;
  json["shapes"] = row.shapes;
  json["isa"] = row.isa;
  json["width"] = row.width;
  json["rays"] = row.rays;
  json["build_milliseconds"] = row.milliseconds;
  json["hit_part"] = row.hit_part;
  json["mrays"] = row.mrays;
  if (row.peer) {
    json["embree_mrays"] = row.peer->mrays;
    json["embree_ratio"] = row.peer->ratio;
    json["embree_disagreements"] = row.peer->disagreements;
  }
  return json;
}

void print_row(const ShapeRow& row, bool is_first) {
  if (is_first) {
    std::printf("\n%s: %s shapes, built in %.0f ms; %s, %u wide, one thread\n", row.scene.c_str(),
                grouped(row.shapes).c_str(), row.milliseconds, row.isa.c_str(), row.width);
  }
  std::printf("  %-15s %5.1f %% hit %9.3f Mrays/s", row.rays.c_str(), 100.0 * row.hit_part,
              row.mrays);
  if (row.peer) {
    std::printf("  %6.2f x Embree (%s %.3f, %llu differ)", row.peer->ratio,
                row.peer->entrance.c_str(), row.peer->mrays,
                static_cast<unsigned long long>(row.peer->disagreements));
  }
  std::printf("\n");
  if (!row.wrong.empty()) std::printf("  WRONG: %s\n", row.wrong.c_str());
  std::fflush(stdout);
}

}  // namespace kiwami::tools
