// SPDX-License-Identifier: Apache-2.0
// What `kiwami inspect` writes; the members of the JSON text are described in docs/inspect.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "measure/coarse_shape.h"
#include "measure/library.h"
#include "measure/tree_summary.h"

namespace kiwami::tools {

/// One tree, summarised.
struct InspectedTree {
  BuildOptions build;
  kiwami_scene_info info;
  uint64_t node_count;  ///< nodes and leaves
  double sah;           ///< the sum of all nodes' costs
  std::optional<double> epo;
  std::optional<double> visits_per_ray;
  std::vector<SummaryRow> rows;
};

/// All trees of one scene.
struct Inspection {
  std::string scene;
  kiwami_scene_info scene_info;
  Vec3 up;
  std::string rays;  ///< the name of the ray set; "" without visits
  uint64_t ray_count = 0;
  CoarseShape shape;
  std::vector<InspectedTree> trees;
};

/// The inspection as one line of JSON.
std::string to_json_text(const Inspection& inspection);

/// Whether this build has the page.
bool has_inspect_page();

/// The page with this JSON text in it.
std::string make_inspect_page(const std::string& json);

}  // namespace kiwami::tools
