// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_layouts.h"

#include <cstdio>
#include <memory>

#include "kiwami/known_scenes.h"
#include "kiwami/options.h"
#include "kiwami/own_run.h"

namespace kiwami::tools {
namespace {

struct ReleaseHandle {
  void operator()(kiwami_bvh* bvh) const { kiwami_bvh_release(bvh); }
  void operator()(kiwami_geometry* geometry) const { kiwami_geometry_release(geometry); }
  void operator()(kiwami_binary_tree* tree) const { kiwami_binary_tree_release(tree); }
};
using BvhHandle = std::unique_ptr<kiwami_bvh, ReleaseHandle>;
using GeometryHandle = std::unique_ptr<kiwami_geometry, ReleaseHandle>;
using TreeHandle = std::unique_ptr<kiwami_binary_tree, ReleaseHandle>;

struct NamedLayout {
  const char* name;
  uint32_t layout;
};
constexpr NamedLayout kLayouts[] = {{"boxes", KIWAMI_BINARY_LAYOUT_BOXES},
                                    {"dual_split", KIWAMI_BINARY_LAYOUT_DUAL_SPLIT}};

/// All triangles in one mesh.
SceneFile joined(const SceneFile& file) {
  SceneFile result;
  result.view = file.view;
  Mesh& all = result.meshes.emplace_back();
  for (const Mesh& mesh : file.meshes) {
    const auto first = static_cast<uint32_t>(all.vertex_count());
    all.vertices.insert(all.vertices.end(), mesh.vertices.begin(), mesh.vertices.end());
    for (const uint32_t index : mesh.indices) all.indices.push_back(first + index);
  }
  return result;
}

/// One binary tree in all layouts, and the scene that says what rays hit.
class LayoutBench {
 public:
  LayoutBench(const std::string& name, const BenchSettings& settings)
      : settings_(settings),
        file_(joined(flatten(load_known_scene(name)))),
        device_(settings.isas.front(), 1),
        scene_(device_, file_, settings.build) {
    const BvhHandle bvh = build();
    for (const NamedLayout& each : kLayouts) {
      kiwami_binary_tree* tree = nullptr;
      throw_on_error(kiwami_binary_tree_create(bvh.get(), each.layout, &tree));
      trees_.emplace_back(tree);
      kiwami_binary_tree_info info;
      info.struct_size = sizeof info;
      throw_on_error(kiwami_binary_tree_get_info(tree, &info));
      const uint64_t triangles = scene_.info().triangle_count;
      rows_.push_back({name,
                       triangles,
                       each.name,
                       info.node_count,
                       info.carve_count,
                       per_triangle(info.node_bytes, triangles),
                       {},
                       ""});
      if (kiwami_binary_tree_validate(tree) != KIWAMI_OK) rows_.back().wrong = "it is not valid";
    }
  }

  std::vector<LayoutRow> run() {
    const Box box = bounds_of(scene_.info());
    for (const BenchRays& rays :
         make_bench_rays(scene_, choose_view(settings_.view, file_, box, 1.0f), box, settings_.rays,
                         settings_.ray_count)) {
      if (!rays.any_hit) trace(rays.set);
    }
    return rows_;
  }

 private:
  BvhHandle build() const {
    const Mesh& mesh = file_.meshes[0];
    kiwami_triangle_mesh_desc mesh_desc;
    throw_on_error(kiwami_triangle_mesh_desc_init(&mesh_desc, sizeof mesh_desc));
    mesh_desc.vertices = mesh.vertices.data();
    mesh_desc.vertex_count = mesh.vertex_count();
    mesh_desc.indices = mesh.indices.data();
    mesh_desc.triangle_count = mesh.triangle_count();
    kiwami_geometry* geometry = nullptr;
    throw_on_error(kiwami_triangle_mesh_create(device_.get(), &mesh_desc, &geometry));
    const GeometryHandle owner(geometry);
    const kiwami_parameter_value builder{KIWAMI_PARAMETER_BUILDER, 0,
                                         static_cast<double>(settings_.build.builder)};
    kiwami_bvh_desc desc;
    throw_on_error(kiwami_bvh_desc_init(&desc, sizeof desc));
    desc.geometry = geometry;
    desc.width = 2;
    desc.parameters = &builder;
    desc.parameter_count = 1;
    kiwami_bvh* bvh = nullptr;
    throw_on_error(kiwami_bvh_build(device_.get(), &desc, &bvh));
    return BvhHandle(bvh);
  }

  void trace(const RaySet& set) {
    std::vector<kiwami_hit> expected(set.rays.size());
    scene_.own_closest_hits(set.rays, expected);
    std::vector<std::vector<kiwami_hit>> hits(trees_.size(),
                                              std::vector<kiwami_hit>(set.rays.size()));
    std::vector<kiwami_binary_visits> visits(trees_.size());
    std::vector<Contender> contenders;
    for (size_t i = 0; i < trees_.size(); ++i) {
      visits[i].struct_size = sizeof visits[i];
      contenders.push_back({[] {},
                            [&, i] {
                              throw_on_error(kiwami_binary_tree_closest_hit(
                                  trees_[i].get(), set.rays.data(), 0, hits[i].data(), 0,
                                  set.rays.size(), &visits[i]));
                            },
                            [] {}});
    }
    const auto seconds = interleaved_seconds(contenders, settings_.rounds, settings_.clock);
    const auto count = static_cast<double>(set.rays.size());
    for (size_t i = 0; i < trees_.size(); ++i) {
      std::vector<double> ratios;
      for (size_t k = 0; k < seconds[i].size(); ++k) {
        ratios.push_back(seconds[0][k] / seconds[i][k]);
      }
      rows_[i].traces.push_back({set.name, count * 1e-6 / median(seconds[i]), median(ratios),
                                 static_cast<double>(visits[i].node_visits) / count,
                                 static_cast<double>(visits[i].plane_tests) / count,
                                 static_cast<double>(visits[i].leaf_visits) / count});
      if (hash_hits(hits[i]) != hash_hits(expected)) {
        rows_[i].wrong = "hits of " + set.name + " are not those of the scene";
      }
    }
  }

  const BenchSettings& settings_;
  SceneFile file_;
  Device device_;
  BuiltScene scene_;
  std::vector<TreeHandle> trees_;
  std::vector<LayoutRow> rows_;
};

}  // namespace

std::vector<LayoutRow> run_layouts(const std::string& scene, const BenchSettings& settings) {
  if (makes_wide_tree(settings.build.builder)) {
    throw UsageError("--builder makes a wide tree, expected one that makes a binary one");
  }
  return LayoutBench(scene, settings).run();
}

nlohmann::ordered_json to_json(const LayoutRow& row, const LayoutTrace& trace) {
  return {{"scene", row.scene},
          {"triangles", row.triangles},
          {"layout", row.layout},
          {"nodes", row.nodes},
          {"carving_nodes", row.carving_nodes},
          {"node_bytes_per_triangle", row.node_bytes},
          {"rays", trace.rays},
          {"mrays", trace.mrays},
          {"ratio", trace.ratio},
          {"node_visits", trace.nodes},
          {"plane_tests", trace.planes},
          {"leaf_visits", trace.leaves},
          {"wrong", row.wrong}};
}

void print_table(const std::vector<LayoutRow>& rows) {
  std::printf("%s: %s triangles; one thread\n", rows.front().scene.c_str(),
              grouped(rows.front().triangles).c_str());
  std::printf("%-11s %10s %9s %7s %-16s %8s %6s %8s %8s %8s\n", "layout", "nodes", "carving",
              "B/tri", "rays", "Mrays/s", "ratio", "nodes", "planes", "leaves");
  for (const LayoutRow& row : rows) {
    for (const LayoutTrace& trace : row.traces) {
      std::printf("%-11s %10s %9s %7.1f %-16s %8.3f %6.2f %8.2f %8.2f %8.2f %s\n",
                  row.layout.c_str(), grouped(row.nodes).c_str(),
                  grouped(row.carving_nodes).c_str(), row.node_bytes, trace.rays.c_str(),
                  trace.mrays, trace.ratio, trace.nodes, trace.planes, trace.leaves,
                  row.wrong.c_str());
    }
  }
}

}  // namespace kiwami::tools
