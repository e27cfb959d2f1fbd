// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// One ISA at one node width, or Embree.
struct DemoRow {
  std::string name;
  uint32_t bvh_width = 0;
  double build_seconds = 0.0;
  double primary_rate = 0.0;     ///< rays a second
  double incoherent_rate = 0.0;  ///< rays a second
  double bytes_per_triangle = 0.0;
  double node_fill = 0.0;
  double leaf_fill = 0.0;
  bool equal_bits = false;
};

/// What `demo` says about a scene. Everything is measured on one thread.
struct DemoTable {
  std::string scene;
  uint64_t triangle_count = 0;
  uint64_t skipped_count = 0;
  uint64_t primary_count = 0;
  uint64_t incoherent_count = 0;
  std::vector<DemoRow> rows;
  std::optional<DemoRow> embree;
};

/// How much is measured.
struct DemoSettings {
  uint32_t width = 512;
  uint32_t height = 384;
  uint32_t rounds = 5;
};

/// Builds the scene for every ISA and native node width, and Embree's, and lets them trace the same
/// rays in turn. The scene must have no instances.
DemoTable measure_demo(const std::string& name, const SceneFile& file,
                       const DemoSettings& settings);

void print_demo(const DemoTable& table);
nlohmann::ordered_json demo_to_json(const DemoTable& table);

}  // namespace kiwami::tools
