// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// How one way to answer a query did against the library's own.
struct QueryRival {
  std::string name;
  double mrays;
  double ratio;            ///< ours / theirs: the median of the ratios of each round
  uint64_t disagreements;  ///< rays with other answers
};

/// A query of one ray set, on one thread.
struct QueryRow {
  std::string scene;
  uint64_t triangles;
  std::string isa;
  uint32_t width;
  std::string query;  ///< one of query_names()
  std::string rays;
  uint32_t max_hits;
  double hits;  ///< found, a ray
  double mrays;
  std::vector<QueryRival> rivals;
  std::string wrong;  ///< what is wrong with the answers, or ""
};

/// "multi_hit", "filter" and "micromap".
const std::vector<std::string>& query_names();

/// Measures queries of these names over a scene, next to what they replace: stepping from hit to
/// hit, and Embree's filter functions where the settings have it as the peer.
void run_queries(const std::string& scene, const std::vector<std::string>& names, uint32_t max_hits,
                 const BenchSettings& settings,
                 const std::function<void(const QueryRow&)>& listener);

nlohmann::ordered_json to_json(const QueryRow& row);
void print_row(const QueryRow& row, bool is_first);

}  // namespace kiwami::tools
