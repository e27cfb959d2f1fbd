// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// How one way to draw triangles by their areas did.
struct DistributionRow {
  std::string scene;
  uint64_t weights;
  std::string method;  ///< radix_tree_forest, alias_table, or binary_search, in the tool
  double build_milliseconds;
  double bytes_per_weight;
  double mean_steps;  ///< comparisons of a draw
  uint32_t most_steps;
  double mega_draws;  ///< a second, million, on one thread
  double ratio;       ///< of that to the binary search's: the median over the rounds
  double unevenness;  ///< mean over the triangles of |drawn - expected| / expected draws, with a
                      ///< low-discrepancy sequence, 16 numbers a triangle
  std::string draws_hash;
  std::string wrong;  ///< what was wrong with the draws; "": nothing
};

/// Draws the triangles of a scene by their areas, with the same random numbers for every method.
std::vector<DistributionRow> run_distributions(const std::string& scene,
                                               const BenchSettings& settings);

nlohmann::ordered_json to_json(const DistributionRow& row);
void print_table(const std::vector<DistributionRow>& rows);

}  // namespace kiwami::tools
