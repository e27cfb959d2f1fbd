// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_tables.h"

#include <algorithm>

#include "kiwami/bench_change.h"
#include "kiwami/bench_distributions.h"
#include "kiwami/bench_layouts.h"
#include "kiwami/bench_lights.h"
#include "kiwami/bench_pipelines.h"
#include "kiwami/bench_queries.h"
#include "kiwami/bench_report.h"
#include "kiwami/bench_shapes.h"
#include "kiwami/bench_structures.h"
#include "kiwami/bench_tetrahedra.h"
#include "kiwami/image.h"
#include "scene/shape_clouds.h"

namespace kiwami::tools {
namespace {

/// The table of pipelines.
int run_pipeline_table(const BenchOptions& options, const BenchSettings& settings,
                       const std::vector<std::string>& scenes) {
  const std::vector<BuildOptions> pipelines =
      choose_pipelines(split_different_words("--pipelines", options.pipelines), settings.build);
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& scene : scenes) {
    bool is_first = true;
    run_pipelines(scene, pipelines, settings, [&](const PipelineRow& row) {
      print_row(row, is_first);
      is_first = false;
      rows.push_back(to_json(row));
      all_right = all_right && row.wrong.empty();
    });
    if (!options.json.empty()) write_file(options.json, rows.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

/// The table of textbook structures.
int run_structure_table(const BenchOptions& options, const BenchSettings& settings,
                        const std::vector<std::string>& scenes) {
  const std::vector<std::string> names = split_different_words("--structures", options.structures);
  check_structures(names);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& scene : scenes) {
    const std::vector<StructureRow> rows = run_structures(scene, names, settings);
    print_table(rows);
    for (const StructureRow& row : rows) {
      for (const StructureTrace& trace : row.traces) json.push_back(to_json(row, trace));
      all_right = all_right && row.wrong.empty();
    }
    if (!options.json.empty()) write_file(options.json, json.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

/// Refits in place of rays.
int run_change_table(const BenchOptions& options, const BenchSettings& settings,
                     const std::vector<std::string>& scenes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& scene : scenes) {
    for (const ChangeRow& row : run_change(scene, settings)) {
      print_row(row, peer_name(settings));
      json.push_back(to_json(row, peer_name(settings)));
      all_right = all_right && row.wrong.empty();
    }
    if (!options.json.empty()) write_file(options.json, json.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

/// The table of queries beyond closest and any hit.
int run_query_table(const BenchOptions& options, const BenchSettings& settings,
                    const std::vector<std::string>& scenes) {
  const std::vector<std::string> names = split_different_words("--queries", options.queries);
  for (const std::string& name : names) {
    if (std::count(query_names().begin(), query_names().end(), name) == 0) {
      throw UsageError("--queries has '" + name + "', expected some of " +
                       joined_words(query_names()));
    }
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& scene : scenes) {
    bool is_first = true;
    run_queries(scene, names, options.max_hits, settings, [&](const QueryRow& row) {
      print_row(row, is_first);
      is_first = false;
      rows.push_back(to_json(row));
      all_right = all_right && row.wrong.empty();
    });
    if (!options.json.empty()) write_file(options.json, rows.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

/// Commits of scenes of many objects in place of rays.
int run_edit_table(const BenchOptions& options, const BenchSettings& settings,
                   const std::vector<std::string>& scenes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  for (const std::string& scene : scenes) {
    for (const EditRow& row : run_edit(scene, options.edit, settings)) {
      print_row(row);
      json.push_back(to_json(row));
    }
    if (!options.json.empty()) write_file(options.json, json.dump(1) + "\n");
  }
  return 0;
}

/// The table of ways to choose among many lights.
int run_light_table(const BenchOptions& options, const BenchSettings& settings,
                    const std::vector<std::string>& scenes) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (const std::string& scene : scenes) {
    bool is_first = true;
    run_lights(scene, options.lights, settings, [&](const LightRow& row) {
      print_row(row, is_first);
      is_first = false;
      rows.push_back(to_json(row));
    });
    if (!options.json.empty()) write_file(options.json, rows.dump(1) + "\n");
  }
  return 0;
}

/// The table of ways to draw triangles by their areas.
int run_distribution_table(const BenchOptions& options, const BenchSettings& settings,
                           const std::vector<std::string>& scenes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& scene : scenes) {
    const std::vector<DistributionRow> rows = run_distributions(scene, settings);
    print_table(rows);
    for (const DistributionRow& row : rows) {
      json.push_back(to_json(row));
      all_right = all_right && row.wrong.empty();
    }
    if (!options.json.empty()) write_file(options.json, json.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

/// The table of layouts of a binary tree.
int run_layout_table(const BenchOptions& options, const BenchSettings& settings,
                     const std::vector<std::string>& scenes) {
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& scene : scenes) {
    const std::vector<LayoutRow> rows = run_layouts(scene, settings);
    print_table(rows);
    for (const LayoutRow& row : rows) {
      for (const LayoutTrace& trace : row.traces) json.push_back(to_json(row, trace));
      all_right = all_right && row.wrong.empty();
    }
    if (!options.json.empty()) write_file(options.json, json.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

}  // namespace

std::optional<int> run_table(const BenchOptions& options, const BenchSettings& settings,
                             const std::vector<std::string>& scenes) {
  if (!options.pipelines.empty()) return run_pipeline_table(options, settings, scenes);
  if (options.edit != 0) return run_edit_table(options, settings, scenes);
  if (options.change) return run_change_table(options, settings, scenes);
  if (!options.structures.empty()) return run_structure_table(options, settings, scenes);
  if (!options.queries.empty()) return run_query_table(options, settings, scenes);
  if (options.binary_layouts) return run_layout_table(options, settings, scenes);
  if (options.distributions) return run_distribution_table(options, settings, scenes);
  if (options.lights.is_asked) return run_light_table(options, settings, scenes);
  return std::nullopt;
}

int run_shape_table(const BenchOptions& options, const BenchSettings& settings) {
  const std::vector<std::string> names = split_different_words("--shapes", options.shapes);
  for (const std::string& name : names) {
    if (std::count(cloud_names().begin(), cloud_names().end(), name) == 0) {
      throw UsageError("--shapes has '" + name + "', expected some of " +
                       joined_words(cloud_names()));
    }
  }
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const std::string& name : names) {
    bool is_first = true;
    run_shapes(name, options.shape_count, settings, [&](const ShapeRow& row) {
      print_row(row, is_first);
      is_first = false;
      rows.push_back(to_json(row));
      all_right = all_right && row.wrong.empty();
    });
    if (!options.json.empty()) write_file(options.json, rows.dump(1) + "\n");
  }
  return all_right ? 0 : kWrongAnswer;
}

int run_tetrahedron_table(const BenchOptions& options, const BenchSettings& settings) {
  const std::vector<TetrahedronRow> rows = run_tetrahedra(options.tetrahedra, settings);
  print_table(rows);
  nlohmann::ordered_json json = nlohmann::ordered_json::array();
  bool all_right = true;
  for (const TetrahedronRow& row : rows) {
    json.push_back(to_json(row));
    all_right = all_right && row.wrong.empty();
  }
  if (!options.json.empty()) write_file(options.json, json.dump(1) + "\n");
  return all_right ? 0 : kWrongAnswer;
}

}  // namespace kiwami::tools
