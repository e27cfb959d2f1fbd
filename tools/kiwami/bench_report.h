// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// The flat rows of the JSON file. Without a peer they lack the members of one.
nlohmann::ordered_json to_json(const BuildRow& row, const std::string& peer);
nlohmann::ordered_json to_json(const TraceRow& row, const std::string& peer);

void print_row(const BuildRow& row, const std::string& peer);
void print_row(const TraceRow& row);

/// The ratios to the peer, gathered by api, threads and kind of query.
class RatioSummary {
 public:
  void add(const TraceRow& row);
  /// The geometric means; nothing when there are no ratios.
  void print(const std::string& peer) const;

 private:
  std::map<std::string, std::vector<double>> ratios_;
};

double geometric_mean(const std::vector<double>& values);

}  // namespace kiwami::tools
