// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <thread>
#include <vector>

#include "kiwami/bench_lights.h"
#include "kiwami/options.h"
#include "kiwami/view_options.h"
#include "measure/peer.h"

namespace kiwami::tools {

/// What the command line of `kiwami bench` says.
struct BenchOptions {
  std::vector<std::string> scenes;
  std::string list;
  std::string scenes_folder = ".";
  std::string peer = *embree_version() != '\0' ? "embree" : "none";
  bool robust = false;
  std::string embree_quality = "default";
  std::string rays;  ///< "": kAllRays, or kPipelineRays in a table of pipelines
  std::string threads = std::thread::hardware_concurrency() > 1 ? "1,2" : "1";
  std::string apis = "single,batch";
  std::string isas = "auto";
  uint32_t bvh_width = 0;
  bool instanced = false;
  std::string motion;
  PipelineOptions pipeline;
  std::string pipelines;
  std::string structures;
  bool change = false;
  bool distributions = false;
  uint32_t tetrahedra = 0;
  bool binary_layouts = false;
  std::string queries;
  uint32_t max_hits = 8;
  uint32_t edit = 0;
  LightBenchOptions lights;
  std::string shapes;
  uint32_t shape_count = 1u << 20;
  uint32_t rounds = 5;
  uint64_t ray_count = 1u << 20;
  std::string clock = "wall";
  std::vector<std::string> parameters;
  ViewOptions view;
  std::string json;

  /// In place of a race with a peer, of the scenes.
  bool asks_for_table() const {
    return !pipelines.empty() || edit != 0 || change || !structures.empty() || !queries.empty() ||
           binary_layouts || distributions || lights.is_asked;
  }
};

}  // namespace kiwami::tools
