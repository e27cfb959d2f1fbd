// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "kiwami/view_options.h"
#include "measure/contest.h"
#include "measure/embree_contender.h"
#include "measure/library.h"

namespace kiwami::tools {

/// How rays are handed over.
enum class BenchApi {
  kSingle,  ///< one ray a call, from as many threads as are measured
  kBatch,   ///< all rays in one call, on a device of as many threads
};
const char* bench_api_name(BenchApi api);

/// Who traces the same rays.
enum class BenchPeer { kNone, kEmbree, kBinary };

/// What is measured. Each combination of the lists is a row.
struct BenchSettings {
  std::vector<std::string> rays;
  std::vector<uint32_t> threads;
  std::vector<BenchApi> apis;
  std::vector<uint32_t> isas;  ///< KIWAMI_ISA_*
  BuildOptions build;
  bool instanced = false;  ///< instances stay instances, here and there
  std::string motion;      ///< see scene/motion.h; "": everything rests
  ViewOptions view;
  BenchPeer peer = BenchPeer::kEmbree;
  bool robust = false;  ///< Embree's robust scene flag
  EmbreeQuality embree_quality = EmbreeQuality::kDefault;
  uint32_t rounds = 5;
  Clock clock = Clock::kWall;  ///< of traces, and of builds in tables of pipelines
  size_t ray_count = 1u << 20;
};

/// What a row is about.
struct BenchCase {
  std::string scene;
  uint64_t triangles;
  uint32_t threads;
  std::string isa;
  uint32_t width;  ///< children a node
};

/// How the other side did on the same rays.
struct PeerTrace {
  std::string entrance;
  double mrays;
  double ratio;            ///< ours / theirs: the median of the ratios of each round
  uint64_t disagreements;  ///< rays that miss here and hit there, or hit at another distance
};

/// What a ray visits on average, traced alone.
struct RayVisits {
  double nodes;
  double leaves;
  double leaf_count_variability;  ///< the standard deviation of the leaves
};

struct TraceRow {
  BenchCase of;
  std::string rays;
  bool any_hit;
  BenchApi api;
  double mrays;  ///< million rays a second, the median of the rounds
  std::optional<PeerTrace> peer;
  RayVisits visits;
  uint64_t hits_hash;
  std::string wrong;  ///< what is wrong with the answers, or ""
};

struct PeerBuild {
  double milliseconds;
  double ratio;  ///< theirs / ours: above 1, ours is faster
  double bytes_per_triangle;
};

struct BuildRow {
  BenchCase of;
  double milliseconds;
  std::optional<PeerBuild> peer;
  double bytes_per_triangle;
  double peak_bytes_per_triangle;
  double sah;
  double epo = 0.0;  ///< end-point overlap
};

/// Told of everything as soon as it is known.
struct BenchListener {
  std::function<void(const BuildRow&)> on_build;
  std::function<void(const TraceRow&)> on_trace;
  std::function<void(uint64_t rays)> on_round;  ///< one side has traced so many more rays
};

/// Measures one scene, a file or a procedural one.
void run_bench(const std::string& scene, const BenchSettings& settings,
               const BenchListener& listener);

/// How many rows of traces run_bench will make of a scene.
size_t trace_row_count(const BenchSettings& settings);

/// "Embree 3.13.5 low robust", "binary BVH", or "".
std::string peer_name(const BenchSettings& settings);

}  // namespace kiwami::tools
