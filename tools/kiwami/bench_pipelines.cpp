// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_pipelines.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <optional>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/own_run.h"
#include "measure/bench_rays.h"
#include "measure/contest.h"
#include "measure/shared_work.h"

namespace kiwami::tools {
namespace {

/// Builds that take longer are not made again: they differ little.
constexpr double kLongBuildSeconds = 0.25;

/// One scene in the table.
class PipelineBench {
 public:
  PipelineBench(const std::string& name, const BenchSettings& settings)
      : name_(name), settings_(settings), file_(load_known_scene(name)) {
    for (const uint32_t threads : settings.threads) {
      works_.push_back(std::make_unique<SharedWork>(threads));
      if (settings.clock == Clock::kProcessor && threads > 1) {
        devices_.push_back(std::make_unique<Device>(settings.isas.front(), *works_.back()));
      } else {
        devices_.push_back(std::make_unique<Device>(settings.isas.front(), threads));
        check_threads(*devices_.back(), threads);
      }
    }
  }

  PipelineRow measure(const BuildOptions& pipeline) {
    PipelineRow row{};
    row.scene = name_;
    row.pipeline = pipeline_name(pipeline);
    try {
      std::unique_ptr<BuiltScene> scene = measure_builds(pipeline, row);
      if (!first_) {
        first_ = std::move(scene);
        make_rays();
      }
      for (size_t i = 0; i < rays_.size(); ++i) {
        measure_trace(scene ? *scene : *first_, i, row);
      }
    } catch (const LibraryError& error) {
      row.wrong = error.what();
    }
    return row;
  }

 private:
  std::unique_ptr<BuiltScene> measure_builds(const BuildOptions& pipeline, PipelineRow& row) const;
  void measure_trace(const BuiltScene& scene, size_t set, PipelineRow& row);

  void make_rays() {
    const Box box = bounds_of(first_->info());
    const View view = choose_view(settings_.view, file_, box, 1.0f);
    rays_ = make_bench_rays(*first_, view, box, settings_.rays, settings_.ray_count);
    hashes_.resize(rays_.size());
  }

  std::string name_;
  const BenchSettings& settings_;
  SceneFile file_;
  std::vector<std::unique_ptr<SharedWork>> works_;  ///< one for each number of threads
  std::vector<std::unique_ptr<Device>> devices_;    ///< the same
  std::unique_ptr<BuiltScene> first_;               ///< by the first pipeline
  std::vector<BenchRays> rays_;
  std::vector<std::optional<uint64_t>> hashes_;  ///< of the first answers to each ray set
};

/// The scene that is returned is on the first device.
std::unique_ptr<BuiltScene> PipelineBench::measure_builds(const BuildOptions& pipeline,
                                                          PipelineRow& row) const {
  std::unique_ptr<BuiltScene> scene;
  std::vector<std::vector<double>> seconds(devices_.size());
  for (uint32_t round = 0; round < std::min(settings_.rounds, kMostBuilds); ++round) {
    if (round > 0 && seconds.front().front() > kLongBuildSeconds) break;
    // The first device is the last one of a round, so that its scene stays.
    for (size_t i = devices_.size(); i-- > 0;) {
      scene.reset();
      const double start = seconds_now(Clock::kProcessor) - works_[i]->saved_seconds();
      scene = std::make_unique<BuiltScene>(*devices_[i], file_, pipeline);
      const double end = seconds_now(Clock::kProcessor) - works_[i]->saved_seconds();
      seconds[i].push_back(settings_.clock == Clock::kProcessor ? end - start
                                                                : scene->info().build_seconds);
    }
  }
  for (size_t i = 0; i < devices_.size(); ++i) {
    row.builds.push_back({settings_.threads[i], median(seconds[i]) * 1e3});
  }
  const kiwami_scene_info& info = scene->info();
  row.triangles = info.triangle_count;
  row.isa = kiwami_isa_name(devices_.front()->info().isa);
  row.width = info.bvh_width;
  row.bytes_per_triangle = per_triangle(info.total_bytes, info.triangle_count);
  row.peak_bytes_per_triangle = per_triangle(info.peak_build_bytes, info.triangle_count);
  row.sah = info.sah_cost;
  row.epo = scene->measures().epo;
  return scene;
}

void PipelineBench::measure_trace(const BuiltScene& scene, size_t set, PipelineRow& row) {
  const BenchRays& rays = rays_[set];
  const BenchApi api = settings_.apis.front();
  OwnRun run(scene, rays, api, settings_.threads.front());
  OwnRun first_run(*first_, rays, api, settings_.threads.front());
  const auto check = [&] {
    const uint64_t hash = run.hash();
    if (!hashes_[set]) hashes_[set] = hash;
    if (hash != *hashes_[set]) row.wrong = "its answers to '" + rays.set.name + "' are others";
  };
  std::vector<Contender> contenders = {{[&] { run.reset(); }, [&] { run.trace(); }, check}};
  if (&scene != first_.get()) {
    contenders.push_back({[&] { first_run.reset(); }, [&] { first_run.trace(); }, [] {}});
  }
  // Once untimed, so that memory and caches are warm.
  for (const Contender& contender : contenders) contender.run();
  const std::vector<std::vector<double>> seconds =
      interleaved_seconds(contenders, settings_.rounds, settings_.clock);
  std::vector<double> ratios;
  for (size_t i = 0; i < settings_.rounds; ++i) {
    ratios.push_back(seconds.back()[i] / seconds.front()[i]);
  }
  const double millions = static_cast<double>(rays.set.rays.size()) * 1e-6;
  row.traces.push_back({rays.set.name, rays.any_hit, millions / median(seconds.front()),
                        median(ratios), visits_of(scene, rays), *hashes_[set]});
}

std::string in_threads(uint32_t threads) {
  return std::to_string(threads) + (threads == 1 ? " thread" : " threads");
}

double mtris_per_second(const PipelineRow& row, const PipelineBuild& build) {
  return static_cast<double>(row.triangles) * 1e-3 / build.milliseconds;
}

void print_head(const PipelineRow& row) {
  std::printf("\n%s: %s triangles; %s, %u wide\n", row.scene.c_str(),
              grouped(row.triangles).c_str(), row.isa.c_str(), row.width);
  std::printf("  %-50s", "pipeline");
  for (const PipelineBuild& build : row.builds) {
    std::printf(" %20s", ("ms (Mtris/s), " + in_threads(build.threads)).c_str());
  }
  std::printf(" %7s %7s %8s %6s", "bytes", "peak", "SAH", "EPO");
  for (const PipelineTrace& trace : row.traces) {
    std::printf(" %36s", ("nodes leaves Mrays/s (x) " + trace.rays).c_str());
  }
  std::printf("\n");
}

}  // namespace

std::vector<BuildOptions> choose_pipelines(const std::vector<std::string>& words,
                                           const BuildOptions& base) {
  const bool all = words == std::vector<std::string>{"all"};
  std::vector<BuildOptions> pipelines;
  for (const std::string& word : all ? method_names(KIWAMI_STAGE_BUILDER) : words) {
    BuildOptions pipeline = base;
    if (word.find('+') != std::string::npos) {
      const BuildOptions named = parse_pipeline("--pipelines", word, base.bvh_width);
      pipeline.builder = named.builder;
      pipeline.optimizers = named.optimizers;
      pipelines.push_back(pipeline);
      continue;
    }
    pipeline.builder = method_of_name(KIWAMI_STAGE_BUILDER, word);
    pipeline.optimizers.clear();
    pipelines.push_back(pipeline);
    for (const std::string& optimizer : method_names(KIWAMI_STAGE_OPTIMIZER)) {
      const uint32_t method = method_of_name(KIWAMI_STAGE_OPTIMIZER, optimizer);
      if (makes_wide_tree(pipeline.builder) && !acts_on_wide_tree(method)) continue;
      pipeline.optimizers = {method};
      pipelines.push_back(pipeline);
    }
  }
  for (const std::string& contraction : method_names(KIWAMI_STAGE_CONTRACTION)) {
    BuildOptions pipeline = base;
    pipeline.optimizers.clear();
    if (makes_wide_tree(base.builder)) pipeline.builder = KIWAMI_BUILDER_BINNED_SAH;
    pipeline.contraction = method_of_name(KIWAMI_STAGE_CONTRACTION, contraction);
    if (pipeline.contraction != base.contraction) pipelines.push_back(pipeline);
  }
  return pipelines;
}

void run_pipelines(const std::string& scene, const std::vector<BuildOptions>& pipelines,
                   const BenchSettings& settings,
                   const std::function<void(const PipelineRow&)>& on_row) {
  PipelineBench bench(scene, settings);
  for (const BuildOptions& pipeline : pipelines) on_row(bench.measure(pipeline));
}

nlohmann::ordered_json to_json(const PipelineRow& row) {
  nlohmann::ordered_json json;
  json["scene"] = row.scene;
  json["triangles"] = row.triangles;
  json["pipeline"] = row.pipeline;
  json["isa"] = row.isa;
  json["width"] = row.width;
  for (const PipelineBuild& build : row.builds) {
    const std::string threads = std::to_string(build.threads);
    json["build_ms_" + threads] = build.milliseconds;
    json["mtris_per_second_" + threads] = mtris_per_second(row, build);
  }
  json["bytes_per_triangle"] = row.bytes_per_triangle;
  json["peak_bytes_per_triangle"] = row.peak_bytes_per_triangle;
  json["sah"] = row.sah;
  json["epo"] = row.epo;
  for (const PipelineTrace& trace : row.traces) {
    json[trace.rays + "_mrays"] = trace.mrays;
    json[trace.rays + "_ratio"] = trace.ratio;
    json[trace.rays + "_node_visits"] = trace.visits.nodes;
    json[trace.rays + "_leaf_visits"] = trace.visits.leaves;
    json[trace.rays + "_hits_hash"] =
        format("%016llx", static_cast<unsigned long long>(trace.hits_hash));
  }
  if (!row.wrong.empty()) json["wrong"] = row.wrong;
  return json;
}

void print_row(const PipelineRow& row, bool is_first) {
  if (is_first) print_head(row);
  std::printf("  %-50s", row.pipeline.c_str());
  for (const PipelineBuild& build : row.builds) {
    std::printf(" %11.1f (%6.2f)", build.milliseconds, mtris_per_second(row, build));
  }
  if (!row.builds.empty()) {
    std::printf(" %7.1f %7.1f %8.2f %6.2f", row.bytes_per_triangle, row.peak_bytes_per_triangle,
                row.sah, row.epo);
  }
  for (const PipelineTrace& trace : row.traces) {
    std::printf(" %13.1f %5.1f %8.3f (%4.2f)", trace.visits.nodes, trace.visits.leaves, trace.mrays,
                trace.ratio);
  }
  std::printf("\n");
  if (!row.wrong.empty()) std::printf("  WRONG: %s\n", row.wrong.c_str());
  std::fflush(stdout);
}

}  // namespace kiwami::tools
