// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// What rays of one set cost in a layout of a binary tree, on one thread.
struct LayoutTrace {
  std::string rays;
  double mrays;
  double ratio;                  ///< of that to the layout with boxes: the median over the rounds
  double nodes, planes, leaves;  ///< visited or compared, a ray
};

struct LayoutRow {
  std::string scene;
  uint64_t triangles;
  std::string layout;  ///< boxes or dual_split
  uint64_t nodes, carving_nodes;
  double node_bytes;  ///< a triangle, without its number
  std::vector<LayoutTrace> traces;
  std::string wrong;  ///< what is wrong with the tree or the answers, or ""
};

/// Builds one binary tree of a scene, its meshes put together, by the settings' builder, and traces
/// the closest-hit sets of the settings' rays through each of its layouts.
std::vector<LayoutRow> run_layouts(const std::string& scene, const BenchSettings& settings);

nlohmann::ordered_json to_json(const LayoutRow& row, const LayoutTrace& trace);
void print_table(const std::vector<LayoutRow>& rows);

}  // namespace kiwami::tools
