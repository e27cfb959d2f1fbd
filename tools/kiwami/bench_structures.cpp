// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_structures.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <iterator>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/own_run.h"
#include "measure/baselines/baseline_peer.h"
#include "measure/baselines/structure.h"

namespace kiwami::tools {
namespace {

const NamedStructure* find_structure(const std::string& name) {
  for (const NamedStructure& known : kStructures) {
    if (name == known.name) return &known;
  }
  return nullptr;
}

/// The structures of one scene, and the library.
class StructureBench {
 public:
  StructureBench(const std::string& name, const std::vector<std::string>& structures,
                 const BenchSettings& settings)
      : settings_(settings),
        file_(load_known_scene(name)),
        device_(settings.isas.front(), 1),
        scene_(device_, file_, settings.build) {
    const kiwami_scene_info& info = scene_.info();
    const std::vector<Corners> triangles = list_triangles(file_);
    for (const std::string& structure : structures) {
      const auto start = std::chrono::steady_clock::now();
      structures_.push_back(find_structure(structure)->build(triangles));
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      add_row(name, structure, spent.count(), structures_.back()->bytes());
    }
    add_row(name, "kiwami", info.build_seconds, info.total_bytes);
    box_ = bounds_of(info);
    rays_ = make_bench_rays(scene_, choose_view(settings.view, file_, box_, 1.0f), box_,
                            settings.rays, settings.ray_count);
  }

  std::vector<StructureRow> run() {
    for (const BenchRays& rays : rays_) trace(rays);
    return rows_;
  }

 private:
  void add_row(const std::string& scene, const std::string& structure, double seconds,
               uint64_t bytes) {
    const uint64_t triangles = scene_.info().triangle_count;
    rows_.push_back(
        {scene, triangles, structure, seconds * 1e3, per_triangle(bytes, triangles), {}, ""});
  }

  void trace(const BenchRays& rays) {
    const std::span<const kiwami_ray> all = rays.set.rays;
    OwnRun own(scene_, rays, BenchApi::kSingle, 1);
    std::vector<std::unique_ptr<PeerRun>> runs;
    std::vector<Contender> contenders;
    for (const auto& structure : structures_) {
      runs.push_back(make_run(*structure, all, rays.any_hit));
      PeerRun* run = runs.back().get();
      contenders.push_back({[run] { run->reset(); }, [run] { run->trace(1); }, [] {}});
    }
    contenders.push_back({[&] { own.reset(); }, [&] { own.trace(); }, [] {}});
    const auto seconds = interleaved_seconds(contenders, settings_.rounds, settings_.clock);
    const auto count = static_cast<double>(all.size());
    for (size_t i = 0; i < structures_.size(); ++i) {
      const StepCounts counts = structures_[i]->count(all, rays.any_hit);
      const uint64_t disagreements =
          count_disagreements(own, *runs[i], all.size(), 1e-6f * box_.diagonal());
      rows_[i].traces.push_back({rays.set.name, count * 1e-6 / median(seconds[i]),
                                 static_cast<double>(counts.steps) / count,
                                 static_cast<double>(counts.triangle_tests) / count,
                                 disagreements});
      if (static_cast<double>(disagreements) > kMostDisagreements * count) {
        rows_[i].wrong = format("%llu of %zu answers contradict the library's",
                                static_cast<unsigned long long>(disagreements), all.size());
      }
    }
    const RayVisits visits = visits_of(scene_, rays);
    rows_.back().traces.push_back(
        {rays.set.name, count * 1e-6 / median(seconds.back()), visits.nodes, visits.leaves, 0});
  }

  const BenchSettings& settings_;
  SceneFile file_;
  Device device_;
  BuiltScene scene_;
  Box box_{};
  std::vector<BenchRays> rays_;
  std::vector<std::unique_ptr<Structure>> structures_;
  std::vector<StructureRow> rows_;  ///< of each structure, and of the library
};

}  // namespace

void check_structures(const std::vector<std::string>& names) {
  std::string known;
  for (const NamedStructure& structure : kStructures) {
    known += (known.empty() ? "" : ", ") + std::string(structure.name);
  }
  for (const std::string& name : names) {
    if (find_structure(name) == nullptr) {
      throw UsageError("--structures has '" + name + "', expected some of " + known);
    }
  }
}

std::vector<StructureRow> run_structures(const std::string& scene,
                                         const std::vector<std::string>& names,
                                         const BenchSettings& settings) {
  return StructureBench(scene, names, settings).run();
}

nlohmann::ordered_json to_json(const StructureRow& row, const StructureTrace& trace) {
  nlohmann::ordered_json json;
  json["scene"] = row.scene;
  json["triangles"] = row.triangles;
  json["structure"] = row.structure;
  json["rays"] = trace.rays;
  json["build_ms"] = row.milliseconds;
  json["bytes_per_triangle"] = row.bytes_per_triangle;
  json["mrays"] = trace.mrays;
  const bool is_own = row.structure == "kiwami";
  json[is_own ? "node_visits" : "steps"] = trace.steps;
  json[is_own ? "leaf_visits" : "triangle_tests"] = trace.triangle_tests;
  json["disagreements"] = trace.disagreements;
  return json;
}

void print_table(const std::vector<StructureRow>& rows) {
  std::printf("\n%s: %s triangles; one thread\n", rows.front().scene.c_str(),
              grouped(rows.front().triangles).c_str());
  std::printf("  %-8s %-15s %10s %8s %9s %9s %9s\n", "", "", "build ms", "bytes", "Mrays/s",
              "steps", "tests");
  for (size_t set = 0; set < rows.front().traces.size(); ++set) {
    for (const StructureRow& row : rows) {
      const StructureTrace& trace = row.traces[set];
      std::printf("  %-8s %-15s %10.1f %8.1f %9.3f %9.1f %9.1f%s\n", row.structure.c_str(),
                  trace.rays.c_str(), row.milliseconds, row.bytes_per_triangle, trace.mrays,
                  trace.steps, trace.triangle_tests,
                  row.structure == "kiwami" ? " (wide nodes, leaf blocks)" : "");
    }
  }
  for (const StructureRow& row : rows) {
    if (!row.wrong.empty())
      std::printf("  WRONG: %s: %s\n", row.structure.c_str(), row.wrong.c_str());
  }
  std::fflush(stdout);
}

}  // namespace kiwami::tools
