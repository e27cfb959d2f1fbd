// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_tables.h"

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

/// The rows of a table: printed as they come, and written to --json after each scene or each row, so
/// that a long run that is stopped has not been in vain.
class RowFile {
 public:
  explicit RowFile(const BenchOptions& options) : file_(options.json) {}

  /// Of a scene whose rows come one by one.
  void start_scene() { is_first_ = true; }
  template <typename Row>
  void show(const Row& row) {
    print_row(row, is_first_);
    is_first_ = false;
    add(row, to_json(row));
    save();
  }

  template <typename Row>
  void add(const Row& row, nlohmann::ordered_json json) {
    json_.push_back(std::move(json));
    if constexpr (requires { row.wrong; }) all_right_ = all_right_ && row.wrong.empty();
  }
  void save() const {
    if (!file_.empty()) write_file(file_, json_.dump(1) + "\n");
  }
  int exit_code() const { return all_right_ ? 0 : kWrongAnswer; }

 private:
  const std::string& file_;
  nlohmann::ordered_json json_ = nlohmann::ordered_json::array();
  bool is_first_ = true;
  bool all_right_ = true;
};

/// A table whose rows of a scene come at once; each has the rays of several sets.
template <typename Row>
void show_all(const std::vector<Row>& rows, RowFile& file) {
  print_table(rows);
  for (const Row& row : rows) {
    if constexpr (requires { row.traces; }) {
      for (const auto& trace : row.traces) file.add(row, to_json(row, trace));
    } else {
      file.add(row, to_json(row));
    }
  }
}

using Scenes = std::vector<std::string>;

/// Calls measure(scene) for each.
template <typename Measure>
int run_scenes(const Scenes& scenes, RowFile& file, Measure&& measure) {
  for (const std::string& scene : scenes) {
    file.start_scene();
    measure(scene);
    file.save();
  }
  return file.exit_code();
}

int run_pipeline_table(const BenchOptions& options, const BenchSettings& settings,
                       const Scenes& scenes, RowFile& file) {
  const std::vector<BuildOptions> pipelines =
      choose_pipelines(split_different_words("--pipelines", options.pipelines), settings.build);
  return run_scenes(scenes, file, [&](const std::string& scene) {
    run_pipelines(scene, pipelines, settings, [&](const PipelineRow& row) { file.show(row); });
  });
}

int run_structure_table(const BenchOptions& options, const BenchSettings& settings,
                        const Scenes& scenes, RowFile& file) {
  const std::vector<std::string> names = split_different_words("--structures", options.structures);
  check_structures(names);
  return run_scenes(scenes, file, [&](const std::string& scene) {
    show_all(run_structures(scene, names, settings), file);
  });
}

int run_query_table(const BenchOptions& options, const BenchSettings& settings,
                    const Scenes& scenes, RowFile& file) {
  const std::vector<std::string> names =
      split_known_words("--queries", options.queries, query_names());
  return run_scenes(scenes, file, [&](const std::string& scene) {
    run_queries(scene, names, options.max_hits, settings,
                [&](const QueryRow& row) { file.show(row); });
  });
}

/// Refits in place of rays.
int run_change_table(const BenchSettings& settings, const Scenes& scenes, RowFile& file) {
  return run_scenes(scenes, file, [&](const std::string& scene) {
    for (const ChangeRow& row : run_change(scene, settings)) {
      print_row(row, peer_name(settings));
      file.add(row, to_json(row, peer_name(settings)));
    }
  });
}

/// Commits of scenes of many objects in place of rays.
int run_edit_table(const BenchOptions& options, const BenchSettings& settings, const Scenes& scenes,
                   RowFile& file) {
  return run_scenes(scenes, file, [&](const std::string& scene) {
    for (const EditRow& row : run_edit(scene, options.edit, settings)) {
      print_row(row);
      file.add(row, to_json(row));
    }
  });
}

}  // namespace

std::optional<int> run_table(const BenchOptions& options, const BenchSettings& settings,
                             const Scenes& scenes) {
  RowFile file(options);
  if (!options.pipelines.empty()) return run_pipeline_table(options, settings, scenes, file);
  if (options.edit != 0) return run_edit_table(options, settings, scenes, file);
  if (options.change) return run_change_table(settings, scenes, file);
  if (!options.structures.empty()) return run_structure_table(options, settings, scenes, file);
  if (!options.queries.empty()) return run_query_table(options, settings, scenes, file);
  if (options.binary_layouts) {
    return run_scenes(scenes, file, [&](const std::string& scene) {
      show_all(run_layouts(scene, settings), file);
    });
  }
  if (options.distributions) {
    return run_scenes(scenes, file, [&](const std::string& scene) {
      show_all(run_distributions(scene, settings), file);
    });
  }
  if (options.lights.is_asked) {
    return run_scenes(scenes, file, [&](const std::string& scene) {
      run_lights(scene, options.lights, settings, [&](const LightRow& row) { file.show(row); });
    });
  }
  return std::nullopt;
}

int run_shape_table(const BenchOptions& options, const BenchSettings& settings) {
  RowFile file(options);
  const Scenes clouds = split_known_words("--shapes", options.shapes, cloud_names());
  return run_scenes(clouds, file, [&](const std::string& cloud) {
    run_shapes(cloud, options.shape_count, settings, [&](const ShapeRow& row) { file.show(row); });
  });
}

int run_tetrahedron_table(const BenchOptions& options, const BenchSettings& settings) {
  RowFile file(options);
  show_all(run_tetrahedra(options.tetrahedra, settings), file);
  file.save();
  return file.exit_code();
}

}  // namespace kiwami::tools
