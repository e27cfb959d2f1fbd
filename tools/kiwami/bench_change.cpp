// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_change.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/own_run.h"
#include "measure/bench_rays.h"
#include "measure/contest.h"
#include "measure/embree_refit.h"

namespace kiwami::tools {
namespace {

/// How far vertices move, as a part of the diagonal, and how many waves the scene has.
constexpr float kAmplitude = 0.01f;
constexpr float kWaves = 20.0f;

/// One scene that moves like water.
class ChangeBench {
 public:
  ChangeBench(const std::string& name, const BenchSettings& settings)
      : name_(name), settings_(settings), still_(load_known_scene(name)), moved_(still_) {}

  std::vector<ChangeRow> run() {
    std::vector<ChangeRow> rows;
    for (const uint32_t isa : settings_.isas) {
      for (const uint32_t threads : settings_.threads) rows.push_back(measure(isa, threads));
    }
    return rows;
  }

 private:
  ChangeRow measure(uint32_t isa, uint32_t threads) {
    const Device device(isa, threads);
    check_threads(device, threads);
    moved_ = still_;
    BuiltScene scene(device, moved_, settings_.build);
    box_ = bounds_of(scene.info());
    ChangeRow row;
    row.of = {name_, scene.info().triangle_count, threads, kiwami_isa_name(device.info().isa),
              scene.info().bvh_width};
    row.sah = scene.info().sah_cost;
    row.build_milliseconds = scene.info().build_seconds * 1e3;
    scene.refit();  // so that both structures that take turns are there
    std::unique_ptr<EmbreeRefit> peer;
    if (settings_.peer == BenchPeer::kEmbree) {
      peer = EmbreeRefit::create(moved_, device.info().isa, threads);
      peer->refit();
    }
    measure_refits(scene, peer.get(), row);
    row.refitted_sah = scene.info().sah_cost;
    row.wrong = check(device, scene);
    return row;
  }

  void measure_refits(BuiltScene& scene, EmbreeRefit* peer, ChangeRow& row) {
    uint32_t own_round = 0, peer_round = 0;
    std::vector<Contender> contenders = {{[&] {
                                            ++own_round;
                                            for (size_t mesh = 0; mesh < moved_.meshes.size();
                                                 ++mesh) {
                                              move(mesh, own_round, moved_.meshes[mesh].vertices);
                                            }
                                          },
                                          [&] { scene.refit(); }, [] {}}};
    if (peer != nullptr) {
      contenders.push_back({[&] {
                              ++peer_round;
                              for (size_t mesh = 0; mesh < moved_.meshes.size(); ++mesh) {
                                move(mesh, peer_round, peer->vertices(mesh));
                              }
                            },
                            [&] { peer->refit(); }, [] {}});
    }
    const auto seconds = interleaved_seconds(contenders, settings_.rounds, settings_.clock);
    row.refit_milliseconds = median(seconds[0]) * 1e3;
    if (peer == nullptr) return;
    std::vector<double> ratios;
    for (size_t i = 0; i < seconds[0].size(); ++i) ratios.push_back(seconds[1][i] / seconds[0][i]);
    row.peer = PeerBuild{median(seconds[1]) * 1e3, median(ratios), 0.0};
  }

  /// Waves along x that rise along all axes.
  void move(size_t mesh, uint32_t round, std::span<float> to) const {
    const std::vector<float>& from = still_.meshes[mesh].vertices;
    const float diagonal = box_.diagonal();
    for (size_t i = 0; i < from.size(); i += 3) {
      const float phase = kWaves * from[i] / diagonal + static_cast<float>(round);
      const float shift = kAmplitude * diagonal * std::sin(phase);
      for (size_t axis = 0; axis < 3; ++axis) to[i + axis] = from[i + axis] + shift;
    }
  }

  /// "" where the answers are those of a scene built anew.
  std::string check(const Device& device, const BuiltScene& scene) const {
    const BuiltScene fresh(device, moved_, settings_.build);
    const View view = choose_view(settings_.view, moved_, bounds_of(fresh.info()), 1.0f);
    for (const BenchRays& rays : make_bench_rays(fresh, view, bounds_of(fresh.info()), {"random"},
                                                 std::min<size_t>(settings_.ray_count, 100000))) {
      std::vector<kiwami_hit> own(rays.set.rays.size()), expected(rays.set.rays.size());
      scene.closest_hits(rays.set.rays, own);
      fresh.closest_hits(rays.set.rays, expected);
      if (hash_hits(own) != hash_hits(expected)) return "its answers are not those of a new scene";
    }
    return "";
  }

  std::string name_;
  const BenchSettings& settings_;
  SceneFile still_, moved_;
  Box box_{};
};

/// So many copies of all meshes of a scene in one, in a cube.
SceneFile copies_of(const SceneFile& file, uint32_t count) {
  Mesh object;
  for (const Mesh& mesh : file.meshes) {
    const auto first = static_cast<uint32_t>(object.vertex_count());
    object.vertices.insert(object.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const uint32_t index : mesh.indices) object.indices.push_back(first + index);
  }
  float extent = 0.0f;
  for (const float coordinate : object.vertices) extent = std::max(extent, std::fabs(coordinate));
  const auto side = static_cast<uint32_t>(std::ceil(std::cbrt(static_cast<double>(count))));
  SceneFile copies;
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t place[3] = {i % side, i / side % side, i / side / side};
    copies.meshes.push_back(object);
    std::vector<float>& vertices = copies.meshes.back().vertices;
    for (size_t k = 0; k < vertices.size(); ++k) {
      vertices[k] += 2.5f * extent * static_cast<float>(place[k % 3]);
    }
  }
  return copies;
}

}  // namespace

std::vector<ChangeRow> run_change(const std::string& scene, const BenchSettings& settings) {
  return ChangeBench(scene, settings).run();
}

std::vector<EditRow> run_edit(const std::string& scene, uint32_t objects,
                              const BenchSettings& settings) {
  const SceneFile copies = copies_of(load_known_scene(scene), objects);
  BuildOptions options = settings.build;
  options.parameters.push_back({KIWAMI_PARAMETER_TWO_LEVEL, 1.0});
  std::vector<EditRow> rows;
  for (const uint32_t isa : settings.isas) {
    for (const uint32_t threads : settings.threads) {
      const Device device(isa, threads);
      check_threads(device, threads);
      SceneFile moved = copies;
      std::vector<Contender> contenders(2);
      std::unique_ptr<BuiltScene> built;
      contenders[0] = {[&] { built.reset(); },
                       [&] { built = std::make_unique<BuiltScene>(device, moved, options); },
                       [] {}};
      const double build = median(interleaved_seconds(
          {contenders.data(), 1}, std::min(settings.rounds, kMostBuilds), settings.clock)[0]);
      size_t round = 0;
      contenders[1] = {[&] {
                         // Any of them, in an order of no pattern.
                         round = (round + moved.meshes.size() * 5 / 8 + 1) % moved.meshes.size();
                         for (float& x : moved.meshes[round].vertices) x += 0.125f;
                       },
                       [&] { built->commit_moved(round); }, [] {}};
      const double edit =
          median(interleaved_seconds({&contenders[1], 1}, settings.rounds, settings.clock)[0]);
      rows.push_back({{scene, built->info().triangle_count, threads,
                       kiwami_isa_name(device.info().isa), built->info().bvh_width},
                      objects,
                      edit * 1e3,
                      build * 1e3});
    }
  }
  return rows;
}

nlohmann::ordered_json to_json(const EditRow& row) {
  nlohmann::ordered_json json;
  json["scene"] = row.of.scene;
  json["triangles"] = row.of.triangles;
  json["objects"] = row.objects;
  json["threads"] = row.of.threads;
  json["isa"] = row.of.isa;
  json["width"] = row.of.width;
  json["edit_ms"] = row.edit_milliseconds;
  json["build_ms"] = row.build_milliseconds;
  return json;
}

void print_row(const EditRow& row) {
  std::printf("\n%s: %s objects, %s triangles; %s, %u wide, %u thread%s\n", row.of.scene.c_str(),
              grouped(row.objects).c_str(), grouped(row.of.triangles).c_str(), row.of.isa.c_str(),
              row.of.width, row.of.threads, row.of.threads == 1 ? "" : "s");
  std::printf("  edit of one %.2f ms; build of all %.1f ms; %.2f %%\n", row.edit_milliseconds,
              row.build_milliseconds, 100.0 * row.edit_milliseconds / row.build_milliseconds);
  std::fflush(stdout);
}

nlohmann::ordered_json to_json(const ChangeRow& row, const std::string& peer) {
  nlohmann::ordered_json json;
  json["scene"] = row.of.scene;
  json["triangles"] = row.of.triangles;
  json["threads"] = row.of.threads;
  json["isa"] = row.of.isa;
  json["width"] = row.of.width;
  json["refit_ms"] = row.refit_milliseconds;
  json["build_ms"] = row.build_milliseconds;
  json["sah"] = row.sah;
  json["refitted_sah"] = row.refitted_sah;
  if (row.peer) {
    json["peer"] = peer;
    json["peer_refit_ms"] = row.peer->milliseconds;
    json["refit_ratio"] = row.peer->ratio;
  }
  if (!row.wrong.empty()) json["wrong"] = row.wrong;
  return json;
}

void print_row(const ChangeRow& row, const std::string& peer) {
  std::printf("\n%s: %s triangles; %s, %u wide, %u thread%s\n", row.of.scene.c_str(),
              grouped(row.of.triangles).c_str(), row.of.isa.c_str(), row.of.width, row.of.threads,
              row.of.threads == 1 ? "" : "s");
  std::printf("  refit %.2f ms", row.refit_milliseconds);
  if (row.peer) {
    std::printf(" (%s %.2f ms, ratio %.2f)", peer.c_str(), row.peer->milliseconds, row.peer->ratio);
  }
  std::printf("; build %.1f ms; SAH %.2f, built %.2f\n", row.build_milliseconds, row.refitted_sah,
              row.sah);
  if (!row.wrong.empty()) std::printf("  WRONG: %s\n", row.wrong.c_str());
  std::fflush(stdout);
}

}  // namespace kiwami::tools
