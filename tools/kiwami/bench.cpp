// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench.h"

#include <algorithm>
#include <limits>
#include <map>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/own_run.h"
#include "measure/baselines/baseline_peer.h"
#include "measure/bench_rays.h"
#include "measure/contest.h"
#include "measure/embree_contender.h"
#include "scene/motion.h"
#include "scene/random.h"

namespace kiwami::tools {
namespace {

// An entrance of a peer that is so much slower than its best one in the warming-up is left out.
constexpr double kHopeless = 1.6;

constexpr uint64_t kTimeSeed = 23;

/// One entrance of a peer that takes part in a contest.
struct PeerSide {
  std::string entrance;
  std::unique_ptr<PeerRun> run;
};

/// The sides that may win, after each has traced the rays once.
std::vector<PeerSide> choose_peer_sides(const PeerScene& peer, const BenchRays& rays, BenchApi api,
                                        uint32_t threads) {
  std::vector<PeerSide> sides;
  std::vector<Contender> contenders;
  for (const PeerEntrance& entrance :
       peer.entrances(rays.set.rays, rays.any_hit, api == BenchApi::kSingle)) {
    sides.push_back({entrance.name, entrance.prepare()});
    PeerRun* run = sides.back().run.get();
    contenders.push_back({[run] { run->reset(); }, [run, threads] { run->trace(threads); }, [] {}});
  }
  if (sides.size() == 1) {
    contenders.front().prepare();
    contenders.front().run();
    return sides;
  }
  const std::vector<std::vector<double>> seconds = interleaved_seconds(contenders, 1);
  double best = std::numeric_limits<double>::infinity();
  for (const std::vector<double>& of_one : seconds) best = std::min(best, of_one[0]);
  std::vector<PeerSide> hopeful;
  for (size_t i = 0; i < sides.size(); ++i) {
    if (seconds[i][0] <= kHopeless * best) hopeful.push_back(std::move(sides[i]));
  }
  return hopeful;
}

/// Everything about one scene.
class SceneBench {
 public:
  SceneBench(const std::string& name, const BenchSettings& settings, const BenchListener& listener)
      : name_(name),
        settings_(settings),
        listener_(listener),
        file_(load_known_scene(name, settings.instanced)) {
    if (!file_.instances.empty()) name_ += " instanced";
    if (settings.motion.empty()) return;
    set_in_motion(file_, settings.motion);
    name_ += " moving";
  }

  void run() {
    for (const uint32_t isa : settings_.isas) {
      for (const uint32_t threads : settings_.threads) run_device(isa, threads);
    }
  }

 private:
  void run_device(uint32_t isa, uint32_t threads);
  BuildRow measure_builds(const Device& device, std::unique_ptr<BuiltScene>& scene,
                          std::unique_ptr<PeerScene>& peer) const;
  std::unique_ptr<PeerScene> build_peer(const Device& device) const;
  TraceRow measure_traces(const BuiltScene& scene, const PeerScene* peer, const BenchRays& rays,
                          BenchApi api, const BenchCase& of);
  double overlap_of(const BuiltScene& scene);
  void check_hash(TraceRow& row, uint64_t hash);
  void make_rays(const BuiltScene& scene);

  std::string name_;
  const BenchSettings& settings_;
  const BenchListener& listener_;
  SceneFile file_;
  std::vector<BenchRays> rays_;
  float least_distance_ = 0.0f;
  std::map<std::string, uint64_t> hashes_;  ///< the first answers to each ray set
  std::map<uint32_t, double> overlaps_;     ///< by width: the tree is the same on every device
};

void SceneBench::run_device(uint32_t isa, uint32_t threads) {
  const Device device(isa, threads);
  check_threads(device, threads);
  std::unique_ptr<BuiltScene> scene;
  std::unique_ptr<PeerScene> peer;
  BuildRow build = measure_builds(device, scene, peer);
  build.epo = overlap_of(*scene);
  if (rays_.empty()) make_rays(*scene);
  listener_.on_build(build);
  std::vector<RayVisits> visits;
  for (const BenchRays& rays : rays_) visits.push_back(visits_of(*scene, rays));
  for (const BenchApi api : settings_.apis) {
    for (size_t i = 0; i < rays_.size(); ++i) {
      TraceRow row = measure_traces(*scene, peer.get(), rays_[i], api, build.of);
      row.visits = visits[i];
      listener_.on_trace(row);
    }
  }
}

double SceneBench::overlap_of(const BuiltScene& scene) {
  // The trees under instances, and of what moves, are others.
  if (!file_.instances.empty() || file_.is_moving()) return 0.0;
  const auto [found, is_new] = overlaps_.try_emplace(scene.info().bvh_width, 0.0);
  if (is_new) found->second = scene.measures().epo;
  return found->second;
}

void SceneBench::make_rays(const BuiltScene& scene) {
  const Box box = bounds_of(scene.info());
  const View view = choose_view(settings_.view, file_, box, 1.0f);
  rays_ = make_bench_rays(scene, view, box, settings_.rays, settings_.ray_count);
  least_distance_ = 1e-6f * box.diagonal();
  if (!file_.is_moving()) return;
  // The rays start where things are at time 0; each then has a time of its own.
  Random random(kTimeSeed);
  for (BenchRays& rays : rays_) {
    for (kiwami_ray& ray : rays.set.rays) ray.time = random.uniform();
  }
}

std::unique_ptr<PeerScene> SceneBench::build_peer(const Device& device) const {
  if (settings_.peer == BenchPeer::kBinary) return make_binary_peer(file_);
  if (settings_.peer == BenchPeer::kNone) return nullptr;
  // Its device has as many threads as ours: oneTBB has one limit for all who use it.
  return EmbreeContender::create(file_, {device.info().isa, device.info().thread_count,
                                         settings_.robust, settings_.embree_quality});
}

BuildRow SceneBench::measure_builds(const Device& device, std::unique_ptr<BuiltScene>& scene,
                                    std::unique_ptr<PeerScene>& peer) const {
  std::vector<double> own;
  std::vector<double> theirs;
  std::vector<double> ratios;
  for (uint32_t i = 0; i < std::min(settings_.rounds, kMostBuilds); ++i) {
    scene.reset();
    peer.reset();
    scene = std::make_unique<BuiltScene>(device, file_, settings_.build);
    own.push_back(scene->info().build_seconds);
    peer = build_peer(device);
    if (!peer) continue;
    theirs.push_back(peer->build_seconds());
    ratios.push_back(theirs.back() / own.back());
  }
  const kiwami_scene_info& info = scene->info();
  BuildRow row;
  row.of = {name_, info.triangle_count, device.info().thread_count,
            kiwami_isa_name(device.info().isa), info.bvh_width};
  row.milliseconds = median(own) * 1e3;
  row.bytes_per_triangle = per_triangle(info.total_bytes, info.triangle_count);
  row.peak_bytes_per_triangle = per_triangle(info.peak_build_bytes, info.triangle_count);
  row.sah = info.sah_cost;
  if (peer) {
    row.peer = PeerBuild{median(theirs) * 1e3, median(ratios),
                         per_triangle(peer->bytes(), info.triangle_count)};
  }
  return row;
}

void SceneBench::check_hash(TraceRow& row, uint64_t hash) {
  const uint64_t expected = hashes_.try_emplace(row.rays, hash).first->second;
  if (hash != expected && row.wrong.empty()) {
    row.wrong =
        format("the hash of the answers is %016llx, of the first ones %016llx",
               static_cast<unsigned long long>(hash), static_cast<unsigned long long>(expected));
  }
}

TraceRow SceneBench::measure_traces(const BuiltScene& scene, const PeerScene* peer,
                                    const BenchRays& rays, BenchApi api, const BenchCase& of) {
  const size_t count = rays.set.rays.size();
  const double millions = static_cast<double>(count) * 1e-6;
  TraceRow row{of, rays.set.name, rays.any_hit, api, 0.0, std::nullopt, {}, 0, ""};
  OwnRun own(scene, rays, api, of.threads);
  own.reset();
  own.trace();
  row.hits_hash = own.hash();
  check_hash(row, row.hits_hash);

  std::vector<Contender> contenders = {{[&] { own.reset(); }, [&] { own.trace(); },
                                        [&] {
                                          check_hash(row, own.hash());
                                          listener_.on_round(count);
                                        }}};
  std::vector<PeerSide> sides;
  if (peer != nullptr) sides = choose_peer_sides(*peer, rays, api, of.threads);
  for (const PeerSide& side : sides) {
    PeerRun* run = side.run.get();
    contenders.push_back({[run] { run->reset(); }, [run, &of] { run->trace(of.threads); },
                          [&] { listener_.on_round(count); }});
  }
  const std::vector<std::vector<double>> seconds =
      interleaved_seconds(contenders, settings_.rounds, settings_.clock);
  row.mrays = millions / median(seconds[0]);
  if (sides.empty()) return row;

  size_t best = 1;
  for (size_t i = 2; i < seconds.size(); ++i) {
    if (median(seconds[i]) < median(seconds[best])) best = i;
  }
  std::vector<double> ratios;
  for (size_t i = 0; i < settings_.rounds; ++i) ratios.push_back(seconds[best][i] / seconds[0][i]);
  const PeerSide& side = sides[best - 1];
  row.peer = PeerTrace{side.entrance, millions / median(seconds[best]), median(ratios),
                       count_disagreements(own, *side.run, count, least_distance_)};
  if (static_cast<double>(row.peer->disagreements) >
      kMostDisagreements * static_cast<double>(count)) {
    row.wrong = format("%llu of %zu answers contradict the peer's",
                       static_cast<unsigned long long>(row.peer->disagreements), count);
  }
  return row;
}

}  // namespace

const char* bench_api_name(BenchApi api) { return api == BenchApi::kSingle ? "single" : "batch"; }

void run_bench(const std::string& scene, const BenchSettings& settings,
               const BenchListener& listener) {
  SceneBench(scene, settings, listener).run();
}

size_t trace_row_count(const BenchSettings& settings) {
  return settings.isas.size() * settings.threads.size() * settings.apis.size() *
         settings.rays.size();
}

std::string peer_name(const BenchSettings& settings) {
  if (settings.peer == BenchPeer::kNone) return "";
  if (settings.peer == BenchPeer::kBinary) return "binary BVH";
  std::string name = std::string("Embree ") + embree_version();
  if (settings.embree_quality == EmbreeQuality::kLow) name += " low";
  if (settings.embree_quality == EmbreeQuality::kHigh) name += " high";
  return name + (settings.robust ? " robust" : "");
}

}  // namespace kiwami::tools
