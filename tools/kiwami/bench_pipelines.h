// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// Ways to build a scene, for a table of what each brings: every builder named (or all of them)
/// alone and with each of the optimisers, or just so where a word is BUILDER+OPTIMIZER or
/// BUILDER+none; and `base`'s builder (binned_sah where that makes the wide tree itself) once more
/// with each contraction that is not its own. What the pipelines have in common is that of `base`.
/// Throws LibraryError for a name that is no builder's, UsageError for a wrong BUILDER+OPTIMIZER.
std::vector<BuildOptions> choose_pipelines(const std::vector<std::string>& words,
                                           const BuildOptions& base);

/// What rays of one set cost in a tree.
struct PipelineTrace {
  std::string rays;
  bool any_hit;
  double mrays;
  double ratio;  ///< to the first pipeline, on the same rays in the same rounds: above 1, faster
  RayVisits visits;
  uint64_t hits_hash;
};

/// What a build took on a number of threads.
struct PipelineBuild {
  uint32_t threads;
  double milliseconds;
};

struct PipelineRow {
  std::string scene;
  uint64_t triangles;
  std::string isa;
  uint32_t width;
  std::string pipeline;
  std::vector<PipelineBuild> builds;
  double bytes_per_triangle;
  double peak_bytes_per_triangle;
  double sah;
  double epo;  ///< end-point overlap
  std::vector<PipelineTrace> traces;
  std::string wrong;  ///< what is wrong with the build or the answers, or ""
};

/// Builds a scene by each pipeline and traces the settings' rays through each tree, on the first of
/// the numbers of threads and by the first api. Calls `on_row` as soon as a row is known.
void run_pipelines(const std::string& scene, const std::vector<BuildOptions>& pipelines,
                   const BenchSettings& settings,
                   const std::function<void(const PipelineRow&)>& on_row);

nlohmann::ordered_json to_json(const PipelineRow& row);

/// A row of the table; a head comes before the first one of each scene.
void print_row(const PipelineRow& row, bool is_first);

}  // namespace kiwami::tools
