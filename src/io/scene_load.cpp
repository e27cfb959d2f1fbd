// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/error.h"
#include "io/file_reader.h"
#include "io/geometry_sections.h"
#include "io/part_checks.h"
#include "io/scene_file.h"
#include "io/tree_sections.h"

namespace kiwami {
namespace {

using namespace file;

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

Vec3f vector_of(const float (&from)[3]) { return {from[0], from[1], from[2]}; }

template <typename Record>
Bounds bounds_of(const Record& record) {
  const Bounds bounds = {vector_of(record.bounds_min), vector_of(record.bounds_max)};
  return bounds.is_empty() ? Bounds::empty() : bounds;
}

void restore_parameters(std::span<const ParameterRecord> records, SceneParameters& parameters) {
  uint32_t optimizers[KIWAMI_MAX_OPTIMIZERS];
  size_t optimizer_count = 0;
  for (const ParameterRecord& record : records) {
    if (record.parameter != kOptimizer) {
      parameters.set(record.parameter, record.value);
      continue;
    }
    if (optimizer_count == KIWAMI_MAX_OPTIMIZERS || !(record.value >= 0 && record.value < 256)) {
      fail("the file has optimizer %g after %zu others, expected at most %d", record.value,
           optimizer_count, KIWAMI_MAX_OPTIMIZERS);
    }
    optimizers[optimizer_count++] = static_cast<uint32_t>(record.value);
  }
  parameters.set_optimizers({optimizers, optimizer_count});
}

/// What a scene committed, in numbers: what its trees may hold.
struct Counts {
  uint64_t triangles = 0;
  uint64_t shapes[3] = {};
  uint64_t moving_triangles = 0;

  void add(const SavedGeometry& geometry) {
    if (!geometry.has(kCommitted)) return;
    const uint64_t count = geometry.record.primitive_count;
    switch (geometry.kind()) {
      case SavedKind::kTriangleMesh:
        triangles += count;
        break;
      case SavedKind::kSpheres:
      case SavedKind::kDiscs:
      case SavedKind::kCurves:
        shapes[geometry.record.kind - static_cast<uint32_t>(SavedKind::kSpheres)] += count;
        break;
      case SavedKind::kMovingMesh:
        moving_triangles += count;
        break;
      case SavedKind::kInstances:
      case SavedKind::kMovingInstances:
      case SavedKind::kNone:
        break;
    }
  }
};

/// References to the scenes of a file, by number.
class LoadedScenes {
 public:
  LoadedScenes(size_t count, Memory& memory) : scenes_(memory, count) { scenes_.fill_zero(); }
  ~LoadedScenes() {
    for (Scene* scene : scenes_) {
      if (scene) scene->release();
    }
  }
  LoadedScenes(const LoadedScenes&) = delete;
  LoadedScenes& operator=(const LoadedScenes&) = delete;

  Scene& operator[](size_t number) const { return *scenes_[number]; }
  Scene& add(size_t number, Device& device) {
    scenes_[number] = Scene::create(device);
    return *scenes_[number];
  }

 private:
  Array<Scene*> scenes_;
};

/// One load, step by step.
class SceneLoader {
 public:
  SceneLoader(Device& device, const kiwami_load_desc& desc)
      : device_(device),
        image_(Reference<FileImage>::adopt(FileImage::create(device, desc))),
        reader_(image_->data(), image_->size()),
        bvh_width_(desc.bvh_width),
        is_trusted_((desc.flags & KIWAMI_LOAD_TRUSTED) != 0) {}

  Reference<Scene> run() {
    reader_.check_kind(KIWAMI_FILE_SCENE);
    const uint32_t count = reader_.scene_count();
    if (count == 0) fail("the file has %u scenes, expected one at least", count);
    Memory& memory = device_.memory();
    if (!is_trusted_) reader_.check_sums(memory, device_.parallel());
    SavedForest forest(reader_, memory);
    if (!is_trusted_ && reader_.has(SectionType::kInstanceStarts)) forest.keep_owned();
    LoadedScenes scenes(count, memory);
    heights_ = Array<uint32_t>(memory, count);
    // What is shown comes first.
    for (uint32_t number = count; number-- != 0;) load(number, forest, scenes);
    return Reference<Scene>(scenes[0]);
  }

 private:
  void load(uint32_t number, SavedForest& forest, LoadedScenes& scenes) {
    Scene& scene = scenes.add(number, device_);
    blame_file([&] {
      restore_parameters(reader_.array<ParameterRecord>(SectionType::kParameters, number),
                         scene.parameters());
    });
    const SavedGeometries geometries(reader_, number);
    heights_[number] = 0;
    geometries.for_each([&](uint32_t id, const SavedGeometry& saved) {
      // Those are checked with their records, or where they are committed anew.
      const bool is_checked_later = saved.kind() == SavedKind::kInstances && saved.has(kCommitted);
      const auto geometry = make_geometry(saved, scenes_of(saved, number, scenes), device_, *image_,
                                          is_trusted_ || is_checked_later);
      scene.attach_as(id, *geometry);
      scene.enable(id, saved.has(kCommitted));
    });
    const auto record = reader_.record<SceneRecord>(SectionType::kScene, number);
    if (bvh_width_ != 0 && bvh_width_ != record.bvh_width) {
      scene.parameters().set(KIWAMI_PARAMETER_BVH_WIDTH, bvh_width_);
      blame_file([&] { scene.commit(); });
    } else {
      restore(number, geometries, record, forest, scene);
    }
    geometries.for_each(
        [&](uint32_t id, const SavedGeometry& saved) { scene.enable(id, saved.has(kEnabled)); });
  }

  /// Those that a geometry shows, which are loaded by now.
  Array<Scene*> scenes_of(const SavedGeometry& saved, uint32_t number, const LoadedScenes& scenes) {
    Array<Scene*> shown(device_.memory(), saved.shown.size());
    for (size_t i = 0; i < shown.size(); ++i) {
      const uint32_t of = saved.shown[i];
      if (of <= number || of >= reader_.scene_count()) {
        fail("scene %u shows scene %u, expected one of %u to %u", number, of, number + 1,
             reader_.scene_count() - 1);
      }
      shown[i] = &scenes[of];
      heights_[number] = std::max(heights_[number], heights_[of] + 1);
    }
    if (heights_[number] > KIWAMI_MAX_INSTANCE_DEPTH) {
      fail("scene %u has paths of %u instances, expected at most %d", number, heights_[number],
           KIWAMI_MAX_INSTANCE_DEPTH);
    }
    return shown;
  }

  void restore(uint32_t number, const SavedGeometries& geometries, const SceneRecord& record,
               SavedForest& forest, Scene& scene) {
    const std::span<const SavedTree> trees = forest.of(number);
    SavedParts parts = parts_of(number, trees, forest);
    if (record.bvh_width != trees[0].width) {
      fail("scene %u is %u wide and its trees are %u, expected the same", number, record.bvh_width,
           trees[0].width);
    }
    if (!is_trusted_) check_contents(number, geometries, parts, trees[0], forest);
    size_t borrowed = parts.motion_bounds.size() + parts.instances.records.size_bytes() +
                      parts.instances.masks.size_bytes() + parts.instances.starts.size_bytes();
    const SavedMovingInstances& moving = parts.instances.moving;
    borrowed += moving.steps.size_bytes() + moving.regular.size_bytes() + moving.boxes.size();
    for (const SavedTree& tree : trees) borrowed += static_cast<size_t>(tree.view.memory_bytes);
    blame_file([&] { scene.restore({image_, trees[0], parts, record.build_seconds, borrowed}); });
    const kiwami_scene_info& info = scene.committed()->info();
    if (info.triangle_count == record.triangle_count && info.node_count == record.node_count) {
      return;
    }
    fail("scene %u has %llu triangles in %llu nodes, expected %llu in %llu", number,
         ull{info.triangle_count}, ull{info.node_count}, ull{record.triangle_count},
         ull{record.node_count});
  }

  SavedParts parts_of(uint32_t number, std::span<const SavedTree> trees,
                      const SavedForest& forest) const {
    SavedParts parts{};
    size_t mesh_tree_count = 0;
    for (const SavedTree& tree : trees) {
      switch (forest.role(tree)) {
        case TreeRole::kTriangles:
          break;
        case TreeRole::kTrianglesOfMesh:
          ++mesh_tree_count;
          break;
        case TreeRole::kInstances:
          parts.instance_tree = &tree;
          break;
        case TreeRole::kMovingInstances:
          parts.moving_instance_tree = &tree;
          break;
        case TreeRole::kSpheres:
        case TreeRole::kDiscs:
        case TreeRole::kCurves:
          parts.shape_trees[static_cast<uint32_t>(forest.role(tree)) -
                            static_cast<uint32_t>(TreeRole::kSpheres)] = &tree;
          break;
        case TreeRole::kMovingTriangles:
          parts.motion_tree = &tree;
          break;
        case TreeRole::kMeshes:
          parts.mesh_tree = &tree;
          break;
      }
    }
    // They follow the first one.
    parts.mesh_trees = trees.subspan(1, mesh_tree_count);
    if (mesh_tree_count != 0 && !parts.mesh_tree) {
      fail("scene %u has trees of meshes and none over them, expected one", number);
    }
    parts.motion_bounds = reader_.array<unsigned char>(SectionType::kMotionBounds, number);
    if (parts.instance_tree) parts.instances = instances_of(number);
    parts.instances.moving = moving_instances_of(number);
    return parts;
  }

  SavedInstances instances_of(uint32_t number) const {
    const auto record = reader_.record<InstancesRecord>(SectionType::kInstances, number);
    SceneParameters rebraiding;
    blame_file([&] {
      rebraiding.set(KIWAMI_PARAMETER_REBRAID, record.rebraid_mode);
      rebraiding.set(KIWAMI_PARAMETER_REBRAID_BUDGET, record.rebraid_budget);
    });
    return {reader_.array<InstanceRecord>(SectionType::kInstanceRecords, number),
            reader_.array<uint32_t>(SectionType::kInstanceMasks, number),
            reader_.array<InstanceStart>(SectionType::kInstanceStarts, number),
            bounds_of(record),
            {record.error_per_origin, record.error_fixed},
            record.far_origin,
            record.rebraid_mode,
            record.rebraid_budget,
            {}};
  }

  /// Of nothing where none moves.
  SavedMovingInstances moving_instances_of(uint32_t number) const {
    const bool is_there =
        !reader_.array<MovingInstancesRecord>(SectionType::kMovingInstances, number).empty();
    if (!is_there) return {{}, {}, {}, Bounds::empty(), {}, 0.0f};
    const auto record =
        reader_.record<MovingInstancesRecord>(SectionType::kMovingInstances, number);
    return {reader_.array<float>(SectionType::kInstanceSteps, number),
            reader_.array<uint32_t>(SectionType::kMovingArrays, number),
            reader_.array<unsigned char>(SectionType::kInstanceBoxes, number),
            bounds_of(record),
            {record.error_per_origin, record.error_fixed},
            record.far_origin};
  }

  void check_contents(uint32_t number, const SavedGeometries& geometries, const SavedParts& parts,
                      const SavedTree& own_tree, SavedForest& forest) const {
    const Parallel& parallel = device_.parallel();
    Counts counts;
    geometries.for_each([&](uint32_t, const SavedGeometry& saved) { counts.add(saved); });
    forest.check(own_tree, counts.triangles, parallel);
    check_mesh_trees(geometries, parts, forest);
    for (size_t kind = 0; kind < 3; ++kind) {
      const SavedTree* const tree = parts.shape_trees[kind];
      if (tree) forest.check(*tree, counts.shapes[kind], parallel);
    }
    if (parts.motion_tree) {
      forest.check(*parts.motion_tree, counts.moving_triangles, parallel);
      check_moving_boxes(reader_.array<float>(SectionType::kMotionBounds, number), parallel);
    }
    if (parts.instance_tree) check_instances_of(number, geometries, parts, forest);
  }

  void check_instances_of(uint32_t number, const SavedGeometries& geometries,
                          const SavedParts& parts, SavedForest& forest) const {
    const Parallel& parallel = device_.parallel();
    Memory& memory = device_.memory();
    GrowingArray<uint32_t> shown(memory);
    GrowingArray<IdRange> resting(memory), moving(memory);
    GrowingArray<InstanceArray> arrays(memory);
    std::span<const float> steps = parts.instances.moving.steps;
    std::span<const uint32_t> regular = parts.instances.moving.regular;
    uint64_t next = 0;
    geometries.for_each([&](uint32_t, const SavedGeometry& saved) {
      if (!saved.has(kCommitted)) return;
      for (const uint32_t scene : saved.shown) shown.push_back(scene);
      const IdRange range = {next, saved.record.primitive_count};
      if (saved.kind() == SavedKind::kInstances) resting.push_back(range);
      if (saved.kind() == SavedKind::kMovingInstances) {
        moving.push_back(range);
        const TransformFormat format = saved.transform_format();
        const size_t size =
            size_t{saved.record.primitive_count} * saved.record.step_count * step_size_of(format);
        const size_t taken = std::min(size, steps.size());
        const bool is_regular = !regular.empty() && regular[0] != 0;
        check_instance_steps(steps.first(taken), format, saved.record.step_count, is_regular,
                             parallel);
        steps = steps.subspan(taken);
        regular = regular.subspan(regular.empty() ? 0 : 1);
      }
      if (!is_instances(saved.kind())) return;
      arrays.push_back({range, saved.kind() == SavedKind::kInstances ? saved.buffers[0] : nullptr,
                        reinterpret_cast<const uint32_t*>(saved.buffers[1]),
                        saved.record.scene_count});
      next += range.count;
    });
    const InstanceContents contents = {{shown.data(), shown.size()},
                                       {arrays.data(), arrays.size()},
                                       {resting.data(), resting.size()},
                                       {moving.data(), moving.size()}};
    const IdRange starts = {0, parts.instances.starts.size()};
    const bool is_rebraided = parts.instances.rebraid_mode != KIWAMI_REBRAID_OFF;
    forest.check(*parts.instance_tree, is_rebraided ? std::span(&starts, 1) : contents.resting,
                 parallel);
    check_instances(parts.instances, contents, forest, parallel);
    if (!parts.moving_instance_tree) return;
    forest.check(*parts.moving_instance_tree, contents.moving, parallel);
    check_moving_boxes(reader_.array<float>(SectionType::kInstanceBoxes, number), parallel);
  }

  /// Each tree holds triangles of its mesh alone, and the one over them as many meshes.
  void check_mesh_trees(const SavedGeometries& geometries, const SavedParts& parts,
                        SavedForest& forest) const {
    size_t mesh_count = 0;
    geometries.for_each([&](uint32_t, const SavedGeometry& saved) {
      const uint32_t count = saved.record.primitive_count;
      if (saved.kind() != SavedKind::kTriangleMesh || !saved.has(kCommitted) || count == 0) return;
      if (mesh_count < parts.mesh_trees.size()) {
        forest.check(parts.mesh_trees[mesh_count], count, device_.parallel());
      }
      ++mesh_count;
    });
    if (parts.mesh_tree) forest.check(*parts.mesh_tree, mesh_count, device_.parallel());
  }

  Device& device_;
  Reference<FileImage> image_;
  FileReader reader_;
  uint32_t bvh_width_;
  bool is_trusted_;
  Array<uint32_t> heights_;  ///< by scene: the instances on the longest path from it
};

}  // namespace

Scene* load_scene(Device& device, const kiwami_load_desc& desc) {
  const Reference<Scene> scene = SceneLoader(device, desc).run();
  scene->retain();
  return scene.get();
}

}  // namespace kiwami
