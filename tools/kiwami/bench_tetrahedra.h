// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// How one way to locate points in a mesh of tetrahedra did.
struct TetrahedronRow {
  uint64_t tetrahedra;
  std::string method;  ///< boxes or faces, or binary_walk, in the tool
  std::string isa;
  std::string points;  ///< random, or along the rows of a grid
  double build_milliseconds;
  double bytes_per_tetrahedron;
  double mega_points;  ///< a second, million, on one thread
  double ratio;        ///< of that to binary_walk's: the median over the rounds
  double found;        ///< of all points
  std::string answers_hash;
  std::string wrong;  ///< what was wrong with the answers; "": nothing
};

/// Locates settings.ray_count points in a grid of cells^3 cubes with six tetrahedra each, whose
/// inner vertices are off their place; one point in twelve lies outside.
std::vector<TetrahedronRow> run_tetrahedra(uint32_t cells, const BenchSettings& settings);

nlohmann::ordered_json to_json(const TetrahedronRow& row);
void print_table(const std::vector<TetrahedronRow>& rows);

}  // namespace kiwami::tools
