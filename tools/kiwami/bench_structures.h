// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// What rays of one set cost in a structure, on one thread, one ray after the other.
struct StructureTrace {
  std::string rays;
  double mrays;
  double steps;            ///< inner nodes or cells a ray
  double triangle_tests;   ///< a ray; of the library: leaf blocks
  uint64_t disagreements;  ///< answers that contradict the library's
};

struct StructureRow {
  std::string scene;
  uint64_t triangles;
  std::string structure;  ///< one of kStructures, or "kiwami"
  double milliseconds;    ///< of the build, on one thread
  double bytes_per_triangle;
  std::vector<StructureTrace> traces;
  std::string wrong;  ///< what is wrong with the answers, or ""
};

/// Throws UsageError for a name that is no structure's.
void check_structures(const std::vector<std::string>& names);

/// Builds textbook structures of these names and the library's tree over a scene, and traces the
/// settings' rays through each, all in turn: why the field uses bounding volume hierarchies.
std::vector<StructureRow> run_structures(const std::string& scene,
                                         const std::vector<std::string>& names,
                                         const BenchSettings& settings);

nlohmann::ordered_json to_json(const StructureRow& row, const StructureTrace& trace);
void print_table(const std::vector<StructureRow>& rows);

}  // namespace kiwami::tools
