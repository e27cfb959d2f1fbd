// SPDX-License-Identifier: Apache-2.0
#include "core/committed_scene.h"

#include <algorithm>
#include <chrono>
#include <functional>

#include "bvh/verify_binary.h"
#include "core/build_primitives.h"
#include "core/error.h"
#include "core/pipeline.h"
#include "core/triangle_mesh.h"
#include "dispatch/dispatch.h"

namespace kiwami {

namespace {

/// Running ids are 32 bits wide, and their highest value names nothing.
constexpr uint64_t kMaxTriangleCount = 0xFFFFFFFEu;

/// How much of a build is done after each of its stages, of the default ones.
constexpr double kCollected = 0.05, kBuilt = 0.6, kMadeWide = 0.9;
/// The same where each mesh has a tree.
constexpr double kMeshesBuilt = 0.9;
/// Of a stage; a guess.
constexpr size_t kTrianglesPerTask = 1024;

uint32_t width_of(const SceneParameters& parameters, const Device& device) {
  const uint32_t width = parameters.whole(KIWAMI_PARAMETER_BVH_WIDTH);
  return width != 0 ? width : default_width_of(device.isa());
}

double ratio(uint64_t part, uint64_t whole) {
  return whole != 0 ? static_cast<double>(part) / static_cast<double>(whole) : 0.0;
}

}  // namespace

CommittedScene::GeometryReferences::GeometryReferences(Memory& memory,
                                                       const AttachedGeometry* geometries,
                                                       size_t count)
    : geometries_(memory, count), by_address_(memory, count), buffers_(memory, count) {
  for (size_t i = 0; i < count; ++i) {
    Geometry& geometry = *geometries[i].geometry;
    geometries_[i] = {&geometry, geometries[i].geometry_id, geometry.mask()};
    geometry.retain();
    by_address_[i] = static_cast<uint32_t>(i);
    buffers_[i] = geometry.replaceable_buffer();
    if (buffers_[i]) buffers_[i]->retain();
  }
  std::sort(by_address_.begin(), by_address_.end(), [this](uint32_t a, uint32_t b) {
    return std::less<Geometry*>()(geometries_[a].geometry, geometries_[b].geometry);
  });
}

CommittedScene::GeometryReferences::~GeometryReferences() {
  for (BufferCopy* buffer : buffers_) {
    if (buffer) buffer->release();
  }
  for (const CommittedGeometry& held : geometries_) held.geometry->release();
}

void CommittedScene::GeometryReferences::swap(GeometryReferences& other) noexcept {
  std::swap(geometries_, other.geometries_);
  std::swap(by_address_, other.by_address_);
  std::swap(buffers_, other.buffers_);
}

size_t CommittedScene::GeometryReferences::copied_bytes() const {
  size_t bytes = 0;
  const Geometry* previous = nullptr;
  for (const uint32_t i : by_address_) {
    const Geometry* const geometry = geometries_[i].geometry;
    if (geometry != previous) bytes += geometry->copied_bytes();
    previous = geometry;
  }
  return bytes;
}

CommittedScene::CommittedScene(Device& device, const AttachedGeometry* geometries, size_t count,
                               const SceneParameters& parameters,
                               std::span<const RepresentativeRay> rays, const Parallel& parallel)
    : device_(device),
      memory_(device.memory().allocator()),
      references_(memory_, geometries, count) {
  const auto start = std::chrono::steady_clock::now();
  number_triangles(geometries, count);
  const uint32_t width = width_of(parameters, device);
  tree_.width = width;
  build(parameters, rays, parallel);
  kernels_ = kernels_of(device.isa(), width, tree_.leaf_layout);
  parts_.build(geometries, count, {parameters, width, memory_, parallel});
  show_parts();
  describe();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  info_.build_seconds = seconds.count();
}

CommittedScene::CommittedScene(Device& device, const AttachedGeometry* geometries, size_t count,
                               const SceneParameters& parameters,
                               std::span<const RepresentativeRay> rays,
                               const CommittedScene* before, bool refits, const Parallel& parallel)
    : device_(device),
      memory_(device.memory().allocator()),
      references_(memory_, geometries, count) {
  const auto start = std::chrono::steady_clock::now();
  const uint32_t width = width_of(parameters, device);
  SceneParameters of_mesh = parameters;
  of_mesh.set(KIWAMI_PARAMETER_TWO_LEVEL, 0);
  // For what is asked about hits; this scene's own tree has none of them.
  number_triangles(geometries, count);
  tree_.width = tree_.leaf_width = width;
  tree_.leaf_layout = wide_tree_config(of_mesh, width).leaf_layout;
  tree_.memory = Array<unsigned char>(memory_, 0);
  kernels_ = kernels_of(device.isa(), width, tree_.leaf_layout);
  parallel.begin_stage(kMeshesBuilt, count);
  meshes_.build({device, geometries, count, of_mesh, rays, width,
                 before ? &before->meshes_ : nullptr, refits},
                memory_, parallel);
  parallel.begin_stage(1.0, count / kTrianglesPerTask);
  show_tree(meshes_.tree().bounds);
  parts_.build(geometries, count, {parameters, width, memory_, parallel});
  parts_.add(meshes_.tree(), meshes_.view());
  show_parts();
  describe();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  info_.build_seconds = seconds.count();
}

CommittedScene::CommittedScene(Device& device, const AttachedGeometry* geometries, size_t count,
                               const SavedScene& saved)
    : device_(device),
      image_(saved.image),
      memory_(device.memory().allocator()),
      references_(memory_, geometries, count),
      tree_(saved.tree.tree()),
      triangle_count_(static_cast<size_t>(saved.tree.primitive_count)) {
  number_triangles(geometries, count);
  const size_t most = saved.parts.mesh_tree ? 0 : numbered_count_;
  if (saved.tree.primitive_count > most) {
    throw Error(KIWAMI_ERROR_INVALID_FILE, "the tree holds %llu triangles, expected at most %zu",
                static_cast<unsigned long long>(saved.tree.primitive_count), most);
  }
  kernels_ = kernels_of(device.isa(), tree_.width, tree_.leaf_layout);
  if (saved.parts.mesh_tree) {
    meshes_.restore(device, geometries, count, *image_, saved.parts, memory_);
  }
  show_tree(saved.parts.mesh_tree ? meshes_.tree().bounds : saved.tree.bounds);
  // What is mapped stays where it is.
  const bool copies_primitives = image_->is_copy() && tree_.leaf_layout == LeafLayout::kTriangles;
  parts_.restore(geometries, count, saved.parts,
                 {tree_.width, copies_primitives, memory_, device.parallel()});
  if (saved.parts.mesh_tree) parts_.add(meshes_.tree(), meshes_.view());
  show_parts();
  describe();
  info_.total_bytes += saved.borrowed_bytes;
  info_.peak_build_bytes += saved.borrowed_bytes;
  info_.build_seconds = saved.build_seconds;
}

void CommittedScene::destroy(CommittedScene* scene) noexcept {
  const Reference<Device> device = scene->device_;
  destroy_object(device->memory(), scene);
}

/// Running ids rise by geometry and then by primitive: their order is the order of equal hits.
void CommittedScene::number_triangles(const AttachedGeometry* geometries, size_t count) {
  mesh_views_ = Array<TriangleMeshView>(memory_, count);
  ranges_ = Array<GeometryRange>(memory_, count);
  view_.has_masks = 0;
  uint64_t next_id = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (geometries[i].geometry->kind() != GeometryKind::kTriangleMesh) continue;
    const TriangleMesh& mesh = static_cast<const TriangleMesh&>(*geometries[i].geometry);
    if (mesh.triangle_count() == 0) continue;
    const uint32_t first_id = static_cast<uint32_t>(next_id);
    next_id += mesh.triangle_count();
    if (next_id > kMaxTriangleCount) {
      throw Error(KIWAMI_ERROR_TOO_LARGE,
                  "the scene has %llu triangles up to geometry %u, expected at most %llu",
                  static_cast<unsigned long long>(next_id), geometries[i].geometry_id,
                  static_cast<unsigned long long>(kMaxTriangleCount));
    }
    mesh_views_[used] = mesh.view(first_id, geometries[i].geometry_id);
    ranges_[used] = {first_id, geometries[i].geometry_id, mesh.mask()};
    if (mesh.mask() != ~uint32_t{0}) view_.has_masks = 1;
    opacities_.set(memory_, used, count, mesh.opacity());
    ++used;
  }
  mesh_views_.shrink(used);
  ranges_.shrink(used);
  numbered_count_ = static_cast<size_t>(next_id);
}

BinaryBvh CommittedScene::build_binary(Array<BuildPrimitive> primitives,
                                       std::span<const RepresentativeRay> rays,
                                       const SceneParameters& parameters,
                                       const Parallel& parallel) {
  BinaryBvh binary = build_binary_bvh(std::move(primitives), source(), rays, parameters,
                                      tree_.width, memory_, parallel);
  if (parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) {
    primitives = collect_build_primitives(source(), numbered_count_, memory_, parallel);
    const TriangleSource triangles = source();
    verify_binary_bvh(binary, primitives.data(), primitives.size(),
                      binary_leaf_size_of(parameters, tree_.width), memory_, &triangles);
  }
  return binary;
}

void CommittedScene::build(const SceneParameters& parameters,
                           std::span<const RepresentativeRay> rays, const Parallel& parallel) {
  Array<RepresentativeRay> sampled;
  if (rays.empty()) {
    sampled = sample_rays_for(parameters, source(), memory_);
    rays = {sampled.data(), sampled.size()};
  }
  WideTreeConfig config = wide_tree_config(parameters, tree_.width);
  config.rays = rays;
  node_cost_ = config.node_cost;
  leaf_cost_ = config.leaf_cost;
  validates_build_ = parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0;
  const size_t expected_tasks = numbered_count_ / kTrianglesPerTask;
  parallel.begin_stage(kCollected, expected_tasks);
  Array<BuildPrimitive> primitives =
      collect_build_primitives(source(), numbered_count_, memory_, parallel);
  triangle_count_ = primitives.size();
  skipped_ids_ = missing_ids(primitives, numbered_count_, memory_);
  parallel.begin_stage(kBuilt, expected_tasks);
  Bounds bounds;
  {
    WideDraft draft;
    if (builds_wide_tree(parameters)) {
      draft = build_wide_draft(std::move(primitives), config, parameters, memory_, parallel);
      parallel.begin_stage(kMadeWide, expected_tasks);
    } else {
      BinaryBvh binary = build_binary(std::move(primitives), rays, parameters, parallel);
      parallel.begin_stage(kMadeWide, expected_tasks);
      draft = contract_to_draft(std::move(binary), source(), config, memory_, parallel);
    }
    bounds = draft.boxes.empty() ? Bounds::empty() : draft.boxes[0];
    tree_ = pack_wide_tree(draft, source(), config, memory_, parallel);
  }
  if (parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) validate();
  parallel.begin_stage(1.0, numbered_count_ / kTrianglesPerTask);
  optimize_wide_tree(tree_, source(), rays, parameters, memory_, parallel);
  if (parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) validate();
  show_tree(bounds);
}

void CommittedScene::show_tree(const Bounds& bounds) {
  tree_bounds_ = bounds;
  view_.tree = tree_.view;
  view_.ranges = ranges_.data();
  view_.range_count = static_cast<uint32_t>(ranges_.size());
  view_.meshes = mesh_views_.data();
  view_.mesh_bytes = 0;
  for (const TriangleMeshView& mesh : mesh_views_) view_.mesh_bytes += mesh.bytes();
  view_.opacities = opacities_.views();
  for (int axis = 0; axis < 3; ++axis) {
    info_.bounds_min[axis] = bounds.lower[axis];
    info_.bounds_max[axis] = bounds.upper[axis];
  }
}

void CommittedScene::show_parts() {
  view_.parts = parts_.views();
  view_.part_count = parts_.count();
  const Bounds bounds = parts_.bounds();
  for (int axis = 0; axis < 3; ++axis) {
    info_.bounds_min[axis] = min_keep(info_.bounds_min[axis], bounds.lower[axis]);
    info_.bounds_max[axis] = max_keep(info_.bounds_max[axis], bounds.upper[axis]);
  }
}

void CommittedScene::describe() {
  const SceneInstances& instances = parts_.instances();
  info_.instance_count = instances.count();
  info_.instance_depth = instances.depth();
  info_.instance_tree_bytes = instances.tree_bytes();
  info_.struct_size = sizeof(info_);
  info_.bvh_width = tree_.width;
  info_.leaf_width = tree_.leaf_width;
  info_.bvh_depth = tree_.depth;
  info_.triangle_count = triangle_count_;
  info_.skipped_count = parts_.skipped_count();
  if (meshes_.empty()) info_.skipped_count += numbered_count_ - triangle_count_;
  info_.node_count = tree_.node_count;
  info_.leaf_block_count = tree_.leaf_block_count;
  info_.node_bytes = tree_.node_bytes();
  info_.leaf_bytes = tree_.leaf_bytes();
  info_.total_bytes = memory_.bytes_in_use() + references_.copied_bytes() + sizeof(*this);
  info_.peak_build_bytes = memory_.peak_bytes() + references_.copied_bytes() + sizeof(*this);
  info_.node_fill = ratio(tree_.used_slots, tree_.node_count * tree_.width);
  info_.leaf_fill = ratio(tree_.used_lanes, tree_.leaf_block_count * tree_.leaf_width);
  info_.sah_cost = tree_.sah_cost;
  info_.reference_count = tree_.used_lanes;
  meshes_.describe(info_);
}

HitError CommittedScene::hit_error() const {
  HitError error = HitError::of_triangles(bounds());
  error.extend(parts_.instances().error());
  return error;
}

void CommittedScene::validate() const {
  verify_wide_tree(tree_, source(), triangle_count_, memory_);
  parts_.validate(memory_, parallel());
  meshes_.validate(memory_);
}

}  // namespace kiwami
