// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

struct LightBenchOptions {
  bool is_asked = false;  ///< --lights
  std::string methods;    ///< between commas; empty: all
  std::string widths = "2,4,8,16";
  double share = 0.1;     ///< of the triangles that shine
  uint32_t samples = 16;  ///< choices a receiver at which errors are compared
  uint32_t receiver_count = 4096;
  bool has_shadows = false;
  double roughness = 0.0;  ///< of glossy receivers; 0: they are diffuse
};

/// How one method did on one instruction set and width.
struct LightRow {
  std::string scene;
  uint64_t lights;
  size_t receivers;
  std::string method;
  std::string isa;
  uint32_t width;  ///< children a node; 0: there is no tree
  double build_milliseconds;
  double bytes_per_light;
  double mega_choices;          ///< a second, million
  double choices_per_receiver;  ///< of one call
  double error;                 ///< mean squared relative error at `samples` choices a receiver
  double error_equal_time;      ///< at the choices made in the time that power takes for `samples`
};

/// Makes a part of a scene's triangles shine and lets the points that the camera sees choose among
/// them. Errors are those of the sum over all lights of what is reflected of what their middles
/// send, with or without occlusion, against the plain loop over all lights.
void run_lights(const std::string& scene, const LightBenchOptions& options,
                const BenchSettings& settings, const std::function<void(const LightRow&)>& on_row);

nlohmann::ordered_json to_json(const LightRow& row);
void print_row(const LightRow& row, bool is_first);

}  // namespace kiwami::tools
