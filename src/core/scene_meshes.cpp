// SPDX-License-Identifier: Apache-2.0
// Why a tree over trees changes no answer: a hit depends on the ray and on the vertices of the
// triangle alone, and the boxes of the tree above are boxes above triangles as those of any node,
// with the margins of its own frame (see kMargin in kernels/ray-inl.h).
#include "core/scene_meshes.h"

#include <algorithm>
#include <limits>

#include "core/committed_scene.h"
#include "core/error.h"
#include "core/triangle_mesh.h"

namespace kiwami {
namespace {

/// Meshes with fewer triangles are built side by side, each on one thread.
constexpr uint32_t kLargeMesh = 16384;

const TriangleMesh* mesh_of(const AttachedGeometry& attached) {
  if (attached.geometry->kind() != GeometryKind::kTriangleMesh) return nullptr;
  const TriangleMesh& mesh = static_cast<const TriangleMesh&>(*attached.geometry);
  return mesh.triangle_count() != 0 ? &mesh : nullptr;
}

/// Of what can be hit; empty where that is nothing.
Bounds bounds_of(const CommittedScene& scene) {
  const kiwami_scene_info& info = scene.info();
  return {{info.bounds_min[0], info.bounds_min[1], info.bounds_min[2]},
          {info.bounds_max[0], info.bounds_max[1], info.bounds_max[2]}};
}

/// How the tree above is built: by default, but a mesh costs as much as a whole tree, so that each
/// has a box of its own.
SceneParameters parameters_above(const SceneParameters& of_meshes) {
  SceneParameters parameters;
  parameters.set(KIWAMI_PARAMETER_MAX_LEAF_SIZE, 1);
  parameters.set(KIWAMI_PARAMETER_VALIDATE_BUILD, of_meshes[KIWAMI_PARAMETER_VALIDATE_BUILD]);
  return parameters;
}

}  // namespace

/// Fills the entries, of which those that have no scene yet are to be built.
class SceneMeshes::Builder {
 public:
  Builder(SceneMeshes& meshes, const Input& input) : meshes_(meshes), input_(input) {}

  void run(Memory& memory, const Parallel& parallel) {
    collect(memory);
    const Parallel one_thread = Parallel::part_of(parallel, true);
    parallel.for_each(places_.size(), [&](size_t i) {
      if (!is_due(i, false)) return;
      make(i, one_thread);
    });
    for (size_t i = 0; i < places_.size(); ++i) {
      if (is_due(i, true)) make(i, Parallel::part_of(parallel, false));
    }
  }

 private:
  /// Takes over the scenes of meshes that are as they were.
  void collect(Memory& memory) {
    size_t count = 0;
    for (size_t i = 0; i < input_.count; ++i) {
      if (mesh_of(input_.geometries[i])) ++count;
    }
    places_ = Array<size_t>(memory, count);
    meshes_.entries_ = Array<Entry>(memory, count);
    size_t next = 0;
    for (size_t i = 0; i < input_.count; ++i) {
      if (!mesh_of(input_.geometries[i])) continue;
      const AttachedGeometry& attached = input_.geometries[i];
      Entry& entry = meshes_.entries_[next];
      places_[next++] = i;
      entry = {nullptr, attached.geometry, attached.geometry->version(), attached.geometry_id};
      const Entry* const old = before(entry);
      if (!old || old->geometry != entry.geometry || old->version != entry.version) continue;
      entry.scene = old->scene;
      entry.scene->retain();
    }
  }

  const Entry* before(const Entry& entry) const {
    return input_.before ? input_.before->find(entry.geometry_id) : nullptr;
  }

  bool is_due(size_t i, bool is_large) const {
    const AttachedGeometry& attached = input_.geometries[places_[i]];
    return !meshes_.entries_[i].scene &&
           (mesh_of(attached)->triangle_count() >= kLargeMesh) == is_large;
  }

  void make(size_t i, const Parallel& parallel) {
    Entry& entry = meshes_.entries_[i];
    const AttachedGeometry& attached = input_.geometries[places_[i]];
    if (input_.refits) entry.scene = refitted(before(entry), attached, parallel);
    if (entry.scene) return;
    entry.scene = make_object<CommittedScene>(input_.device.memory(), input_.device, &attached,
                                              size_t{1}, input_.parameters, input_.rays, parallel);
  }

  /// nullptr where the old tree is of no use.
  CommittedScene* refitted(const Entry* old, const AttachedGeometry& attached,
                           const Parallel& parallel) const {
    if (!old || !old->scene->fits(&attached, 1)) return nullptr;
    Reference<CommittedScene> moved = Reference<CommittedScene>::adopt(
        make_object<CommittedScene>(input_.device.memory(), *old->scene, parallel));
    const uint64_t refit_count = old->scene->info().refit_count + 1;
    if (!moved->refit(&attached, 1, refit_count, parallel)) return nullptr;
    moved->retain();
    return moved.get();
  }

  SceneMeshes& meshes_;
  const Input& input_;
  Array<size_t> places_;  ///< of the meshes, among the geometries
};

SceneMeshes::~SceneMeshes() {
  for (const Entry& entry : entries_) {
    if (entry.scene) entry.scene->release();
  }
}

void SceneMeshes::build(const Input& input, Memory& memory, const Parallel& parallel) {
  Builder(*this, input).run(memory, parallel);
  show(memory);
  const SceneParameters above = parameters_above(input.parameters);
  tree_ = build_part_tree(boxes(memory), {above, input.width, memory, parallel});
}

void SceneMeshes::show(Memory& memory) {
  views_ = Array<const SceneView*>(memory, entries_.size());
  for (size_t i = 0; i < entries_.size(); ++i) views_[i] = &entries_[i].scene->view();
  data_ = {views_.data()};
}

void SceneMeshes::restore(Device& device, const AttachedGeometry* geometries, size_t count,
                          FileImage& image, const SavedParts& saved, Memory& memory) {
  size_t mesh_count = 0;
  for (size_t i = 0; i < count; ++i) mesh_count += mesh_of(geometries[i]) ? 1 : 0;
  if (saved.mesh_trees.size() != mesh_count || saved.mesh_tree->primitive_count > mesh_count) {
    throw Error(KIWAMI_ERROR_INVALID_FILE,
                "the scene has %zu trees of meshes, and one over %llu of them, expected %zu",
                saved.mesh_trees.size(),
                static_cast<unsigned long long>(saved.mesh_tree->primitive_count), mesh_count);
  }
  entries_ = Array<Entry>(memory, mesh_count);
  entries_.fill_zero();
  const SavedParts nothing{};
  size_t next = 0;
  for (size_t i = 0; i < count; ++i) {
    if (!mesh_of(geometries[i])) continue;
    const AttachedGeometry& attached = geometries[i];
    Entry& entry = entries_[next];
    entry = {nullptr, attached.geometry, attached.geometry->version(), attached.geometry_id};
    const SavedScene scene{Reference<FileImage>(image), saved.mesh_trees[next++], nothing, 0.0, 0};
    entry.scene = make_object<CommittedScene>(device.memory(), device, &attached, size_t{1}, scene);
  }
  show(memory);
  tree_ = saved.mesh_tree->part();
}

ScenePart SceneMeshes::view() const {
  return {PartKind::kMeshes, tree_.tree.view, &data_, std::numeric_limits<float>::infinity(), 0.0f};
}

const SceneMeshes::Entry* SceneMeshes::find(uint32_t geometry_id) const {
  const Entry* const found =
      std::lower_bound(entries_.begin(), entries_.end(), geometry_id,
                       [](const Entry& entry, uint32_t id) { return entry.geometry_id < id; });
  return found != entries_.end() && found->geometry_id == geometry_id ? found : nullptr;
}

/// Of those that show something, by their index.
Array<BuildPrimitive> SceneMeshes::boxes(Memory& memory) const {
  Array<BuildPrimitive> boxes(memory, entries_.size());
  size_t used = 0;
  for (size_t i = 0; i < entries_.size(); ++i) {
    const Bounds box = bounds_of(*entries_[i].scene);
    if (box.is_empty()) continue;
    boxes[used++] = {box.lower, static_cast<uint32_t>(i), box.upper, 0};
  }
  boxes.shrink(used);
  return boxes;
}

void SceneMeshes::describe(kiwami_scene_info& info) const {
  if (empty()) return;
  double used_slots = 0.0, used_lanes = 0.0, slots = 0.0, lanes = 0.0, cost = 0.0;
  uint32_t depth = 0;
  const double root_area = double{tree_.bounds.half_area()};
  const auto add = [&](const WideTree& tree) {
    info.node_count += tree.node_count;
    info.node_bytes += tree.node_bytes();
    info.leaf_bytes += tree.leaf_bytes();
    used_slots += static_cast<double>(tree.used_slots);
    slots += static_cast<double>(tree.node_count * tree.width);
  };
  for (const Entry& entry : entries_) {
    const kiwami_scene_info& of = entry.scene->info();
    const WideTree& tree = entry.scene->tree();
    add(tree);
    info.leaf_block_count += tree.leaf_block_count;
    info.reference_count += tree.used_lanes;
    used_lanes += static_cast<double>(tree.used_lanes);
    lanes += static_cast<double>(tree.leaf_block_count * tree.leaf_width);
    info.triangle_count += of.triangle_count;
    info.skipped_count += of.skipped_count;
    info.total_bytes += entry.scene->own_bytes();
    info.peak_build_bytes += entry.scene->own_bytes();
    depth = std::max(depth, of.bvh_depth);
    const double area = double{bounds_of(*entry.scene).half_area()};
    cost += root_area > 0.0 ? of.sah_cost * area : of.sah_cost;
  }
  const WideTree& above = tree_.tree;
  add(above);
  info.bvh_depth = above.depth + depth;
  info.node_fill = slots > 0.0 ? used_slots / slots : 0.0;
  info.leaf_fill = lanes > 0.0 ? used_lanes / lanes : 0.0;
  info.sah_cost = above.sah_cost + (root_area > 0.0 ? cost / root_area : cost);
}

void SceneMeshes::validate(Memory& memory) const {
  if (empty()) return;
  for (const Entry& entry : entries_) entry.scene->validate();
  const Array<BuildPrimitive> all = boxes(memory);
  verify_wide_tree(tree_.tree, {all.data(), all.size()}, memory);
}

}  // namespace kiwami
