// SPDX-License-Identifier: Apache-2.0
#include "core/error.h"
#include "io/file_writer.h"
#include "io/geometry_sections.h"
#include "io/scene_file.h"
#include "io/scene_walk.h"
#include "io/tree_sections.h"

namespace kiwami {
namespace {

using namespace file;

/// Trees that are at least as large have pages of their own.
constexpr size_t kLargeTree = 16 * kPageAlignment;

void copy(const Vec3f& from, float (&to)[3]) {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

InstancesRecord record_of_instances(const SavedInstances& instances) {
  InstancesRecord record{};
  copy(instances.bounds.lower, record.bounds_min);
  copy(instances.bounds.upper, record.bounds_max);
  record.far_origin = instances.far_origin;
  record.rebraid_mode = instances.rebraid_mode;
  record.rebraid_budget = instances.rebraid_budget;
  record.error_per_origin = instances.error.per_origin;
  record.error_fixed = instances.error.fixed;
  return record;
}

MovingInstancesRecord record_of_moving(const SavedMovingInstances& moving) {
  MovingInstancesRecord record{};
  copy(moving.bounds.lower, record.bounds_min);
  copy(moving.bounds.upper, record.bounds_max);
  record.far_origin = moving.far_origin;
  record.error_per_origin = moving.error.per_origin;
  record.error_fixed = moving.error.fixed;
  return record;
}

/// The quality first, since it sets others.
Array<ParameterRecord> records_of(const SceneParameters& parameters, Memory& memory) {
  GrowingArray<ParameterRecord> records(memory);
  const auto add = [&](uint32_t number) { records.push_back({number, 0, parameters[number]}); };
  add(KIWAMI_PARAMETER_QUALITY);
  for (uint32_t number = 0; number < SceneParameters::kLimit; ++number) {
    if (is_parameter(number) && number != KIWAMI_PARAMETER_QUALITY) add(number);
  }
  for (const uint32_t method : parameters.optimizers()) {
    records.push_back({kOptimizer, 0, static_cast<double>(method)});
  }
  return records.take();
}

/// All trees of a scene, by their roles: calls visit(TreeRecord, WideTree).
template <typename Visit>
void for_each_tree(const CommittedScene& scene, Visit&& visit) {
  const auto visit_part = [&](TreeRole role, const PartTree& part) {
    // What has no width was never built: there is nothing of its kind.
    if (part.tree.width != 0) visit(record_of(role, part), part.tree);
  };
  const SceneMeshes& meshes = scene.meshes();
  const SceneParts& parts = scene.parts();
  const uint64_t own_count = meshes.empty() ? scene.info().triangle_count : 0;
  visit(record_of(TreeRole::kTriangles, scene.tree(), scene.tree_bounds(), own_count),
        scene.tree());
  for (size_t i = 0; i < meshes.count(); ++i) {
    const CommittedScene& mesh = meshes.scene(i);
    visit(record_of(TreeRole::kTrianglesOfMesh, mesh.tree(), mesh.bounds(),
                    mesh.info().triangle_count),
          mesh.tree());
  }
  visit_part(TreeRole::kInstances, parts.instances().part_tree());
  visit_part(TreeRole::kMovingInstances, parts.instances().moving().tree());
  visit_part(TreeRole::kSpheres, parts.shapes(ShapeKind::kSphere).tree());
  visit_part(TreeRole::kDiscs, parts.shapes(ShapeKind::kDisc).tree());
  visit_part(TreeRole::kCurves, parts.shapes(ShapeKind::kCurve).tree());
  visit_part(TreeRole::kMovingTriangles, parts.motion().tree());
  visit_part(TreeRole::kMeshes, meshes.tree());
}

/// Calls visit with what makes the record and the buffers of each geometry: visit(geometry_id,
/// TriangleMeshView, OpacityMap or nullptr), or visit(geometry_id, geometry) with one of its kind.
/// Static meshes are as they were when the scene was committed.
template <typename Visit>
void for_each_geometry(const CommittedScene& scene, const Array<GeometryToSave>& geometries,
                       Visit&& visit) {
  const TriangleSource source = scene.source();
  uint32_t next = 0;
  for (size_t id = 0; id < geometries.size(); ++id) {
    const Geometry* const geometry = geometries[id].geometry;
    if (!geometry) continue;
    if (geometry->kind() == GeometryKind::kTriangleMesh) {
      const auto& mesh = static_cast<const TriangleMesh&>(*geometry);
      const bool is_in_source = next < source.mesh_count && source.meshes[next].geometry_id == id;
      if (is_in_source) {
        visit(id, source.meshes[next], scene.opacity_of(next));
        ++next;
      } else {
        visit(id, mesh.view(0, 0), static_cast<const OpacityMap*>(mesh.opacity()));
      }
    } else if (geometry->kind() == GeometryKind::kInstances) {
      visit(id, static_cast<const Instances&>(*geometry));
    } else if (geometry->kind() == GeometryKind::kMovingMesh) {
      visit(id, static_cast<const MovingMesh&>(*geometry));
    } else {
      visit(id, static_cast<const Shapes&>(*geometry));
    }
  }
}

/// What one scene adds to the file. The tables are here, the rest is written from where it lies.
class SceneTables {
 public:
  SceneTables(const SceneToSave& saved, const SceneWalk& walk, Memory& memory);
  void add_to(FileWriter& writer, uint32_t number) const;

 private:
  void add_trees_to(FileWriter& writer, uint32_t number) const;

  const CommittedScene& committed_;
  SceneRecord scene_{};
  InstancesRecord instances_;
  MovingInstancesRecord moving_instances_;
  Array<ParameterRecord> parameters_;
  Array<GeometryToSave> geometries_;
  Array<GeometryRecord> records_;
  Array<uint32_t> shown_;
  Array<TreeRecord> trees_;
};

SceneTables::SceneTables(const SceneToSave& saved, const SceneWalk& walk, Memory& memory)
    : committed_(*saved.committed),
      instances_(record_of_instances(committed_.parts().instances().saved())),
      moving_instances_(record_of_moving(committed_.parts().instances().moving().saved())),
      parameters_(records_of(saved.scene->parameters(), memory)),
      geometries_(geometries_of(saved, memory)),
      records_(memory, geometries_.size()) {
  const kiwami_scene_info& info = committed_.info();
  scene_.bvh_width = committed_.width();
  scene_.triangle_count = info.triangle_count;
  scene_.node_count = info.node_count;
  scene_.build_seconds = info.build_seconds;
  records_.fill_zero();
  for_each_geometry(committed_, geometries_, [&](size_t id, const auto&... parts) {
    records_[id] = record_of(parts...);
    records_[id].flags |= geometries_[id].flags;
    records_[id].mask = geometries_[id].mask;
  });
  const Array<SceneToSave> scenes = shown_scenes(saved, geometries_, memory);
  shown_ = Array<uint32_t>(memory, scenes.size());
  for (size_t i = 0; i < scenes.size(); ++i) shown_[i] = walk.number_of(*scenes[i].committed);
  GrowingArray<TreeRecord> trees(memory);
  for_each_tree(committed_,
                [&](const TreeRecord& record, const WideTree&) { trees.push_back(record); });
  trees_ = trees.take();
}

void SceneTables::add_to(FileWriter& writer, uint32_t number) const {
  writer.begin_section(SectionType::kScene, number);
  writer.add(&scene_, 1);
  writer.add_section(SectionType::kParameters, number, parameters_);
  writer.add_section(SectionType::kGeometries, number, records_);
  writer.add_section(SectionType::kShownScenes, number, shown_);
  writer.add_section(SectionType::kTreeRecords, number, trees_);
  const SceneInstances& instances = committed_.parts().instances();
  if (!instances.empty()) {
    writer.begin_section(SectionType::kInstances, number);
    writer.add(&instances_, 1);
    const SavedInstances saved = instances.saved();
    writer.add_section(SectionType::kInstanceRecords, number, saved.records);
    writer.add_section(SectionType::kInstanceMasks, number, saved.masks);
    writer.add_section(SectionType::kInstanceStarts, number, saved.starts);
    if (!instances.moving().empty()) {
      writer.begin_section(SectionType::kMovingInstances, number);
      writer.add(&moving_instances_, 1);
      writer.add_section(SectionType::kInstanceSteps, number, saved.moving.steps);
      writer.add_section(SectionType::kInstanceBoxes, number, saved.moving.boxes);
      writer.add_section(SectionType::kMovingArrays, number, saved.moving.regular);
    }
  }
  writer.begin_section(SectionType::kBuffers, number);
  for_each_geometry(committed_, geometries_,
                    [&](size_t, const auto&... parts) { add_buffers(writer, parts...); });
  writer.add_section(SectionType::kMotionBounds, number, committed_.parts().motion().bounds());
  add_trees_to(writer, number);
}

void SceneTables::add_trees_to(FileWriter& writer, uint32_t number) const {
  size_t bytes = 0;
  for_each_tree(committed_,
                [&](const TreeRecord&, const WideTree& tree) { bytes += tree.memory.size(); });
  writer.begin_section(SectionType::kTrees, number,
                       bytes >= kLargeTree ? kPageAlignment : kSectionAlignment);
  for_each_tree(committed_, [&](const TreeRecord&, const WideTree& tree) {
    writer.align();
    writer.add(tree.memory.data(), tree.memory.size());
  });
}

/// The tables of all scenes, which stay until the file is written.
class AllTables {
 public:
  AllTables(const SceneWalk& walk, Memory& memory)
      : memory_(memory), tables_(memory, walk.scenes().size()) {
    try {
      for (const SceneToSave& scene : walk.scenes()) {
        tables_[count_] = make_object<SceneTables>(memory, scene, walk, memory);
        ++count_;
      }
    } catch (...) {
      end();
      throw;
    }
  }
  ~AllTables() { end(); }
  AllTables(const AllTables&) = delete;
  AllTables& operator=(const AllTables&) = delete;

  void add_to(FileWriter& writer) const {
    for (uint32_t i = 0; i < count_; ++i) tables_[i]->add_to(writer, i);
  }

 private:
  void end() noexcept {
    for (uint32_t i = 0; i < count_; ++i) destroy_object(memory_, tables_[i]);
  }

  Memory& memory_;
  Array<SceneTables*> tables_;
  uint32_t count_ = 0;
};

}  // namespace

uint64_t save_scene(const Scene& scene, const CommittedScene& committed,
                    const kiwami_save_desc& desc) {
  Memory& memory = scene.device().memory();
  const SceneWalk walk({&scene, &committed}, memory);
  const AllTables tables(walk, memory);
  FileWriter writer(KIWAMI_FILE_SCENE, memory, committed.parallel());
  tables.add_to(writer);
  return save(writer, desc);
}

}  // namespace kiwami
