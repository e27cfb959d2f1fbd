// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kiwami/bench.h"
#include "scene/shape_clouds.h"

namespace kiwami::tools {

/// A generated scene of shapes, traced on one thread.
struct ShapeRow {
  std::string scene;  ///< one of cloud_names()
  uint64_t shapes;
  std::string isa;
  uint32_t width;
  std::string rays;
  double milliseconds;  ///< of the build
  double hit_part;      ///< of the rays
  double mrays;
  std::optional<PeerTrace> peer;  ///< Embree, one ray a call
  std::string wrong;              ///< what is wrong with the answers, or ""
};

/// Measures a scene of about `count` shapes next to Embree's own geometries of their kind, where
/// the settings have it as the peer.
void run_shapes(const std::string& cloud, uint32_t count, const BenchSettings& settings,
                const std::function<void(const ShapeRow&)>& listener);

nlohmann::ordered_json to_json(const ShapeRow& row);
void print_row(const ShapeRow& row, bool is_first);

}  // namespace kiwami::tools
