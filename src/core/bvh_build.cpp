// SPDX-License-Identifier: Apache-2.0
// Trees over the caller's boxes or mesh: how they are built, moved and checked.
#include <chrono>

#include "bvh/flat_edit.h"
#include "bvh/verify_binary.h"
#include "core/build_primitives.h"
#include "core/bvh.h"
#include "core/error.h"
#include "core/pipeline.h"

namespace kiwami {
namespace {

/// Boxes that one task reads.
constexpr size_t kBlockSize = 8192;

/// Primitives of a binary tree's leaf unless the caller says how many.
constexpr uint32_t kBinaryLeafSize = 4;

bool is_valid(const Bounds& box) {
  for (int axis = 0; axis < 3; ++axis) {
    // Comparisons with NaN are false.
    if (!(-KIWAMI_MAX_COORDINATE <= box.lower[axis] && box.lower[axis] <= box.upper[axis] &&
          box.upper[axis] <= KIWAMI_MAX_COORDINATE)) {
      return false;
    }
  }
  return true;
}

/// By id; those that cannot be in a tree are empty.
Array<Bounds> read_boxes(const BoxArray& boxes, Memory& memory, const Parallel& parallel) {
  Array<Bounds> read(memory, boxes.count);
  parallel.for_blocks(boxes.count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const Bounds box = boxes[i];
      read[i] = is_valid(box) ? box : Bounds::empty();
    }
  });
  return read;
}

Array<BuildPrimitive> primitives_of(const Array<Bounds>& boxes, Memory& memory) {
  Array<BuildPrimitive> primitives(memory, boxes.size());
  size_t count = 0;
  for (size_t i = 0; i < boxes.size(); ++i) {
    if (boxes[i].is_empty()) continue;
    primitives[count++] = {boxes[i].lower, static_cast<uint32_t>(i), boxes[i].upper, 0};
  }
  primitives.shrink(count);
  return primitives;
}

uint32_t leaf_width_of(const BvhPlan& plan) {
  const uint32_t asked = plan.parameters.whole(KIWAMI_PARAMETER_MAX_LEAF_SIZE);
  if (plan.width == 2) return asked != 0 ? asked : kBinaryLeafSize;
  return asked != 0 ? std::min(asked, plan.width) : plan.width;
}

}  // namespace

Bvh::Bvh(Device& device, const BvhPlan& plan) : device_(device) {
  const auto start = std::chrono::steady_clock::now();
  Memory& memory = device.memory();
  if (plan.mesh) {
    mesh_ = Reference<TriangleMesh>(*plan.mesh);
    take_vertices();
    numbered_count_ = plan.mesh->triangle_count();
  } else {
    boxes_ = read_boxes(plan.boxes, memory, device.parallel());
    numbered_count_ = plan.boxes.count;
  }
  Array<BuildPrimitive> primitives = collect(source());
  skipped_ids_ = missing_ids(primitives, numbered_count_, memory);
  build(std::move(primitives), plan);
  info_.skipped_count = skipped_ids_.size();
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  info_.build_seconds = seconds.count();
  describe(plan.width, leaf_width_of(plan));
  if (plan.parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) validate();
}

/// Those that the mesh has now.
void Bvh::take_vertices() {
  mesh_view_ = mesh_->view(0, 0);
  BufferCopy* const copy = mesh_->replaceable_buffer();
  mesh_vertices_ = copy ? Reference<BufferCopy>(*copy) : Reference<BufferCopy>();
}

Array<BuildPrimitive> Bvh::collect(const TriangleSource& source) const {
  Memory& memory = device_->memory();
  if (is_over_boxes()) return primitives_of(boxes_, memory);
  return collect_build_primitives(source, numbered_count_, memory, device_->parallel());
}

void Bvh::build(Array<BuildPrimitive> primitives, const BvhPlan& plan) {
  Memory& memory = device_->memory();
  const Parallel& parallel = device_->parallel();
  SceneParameters parameters = plan.parameters;
  uint32_t width = plan.width;
  if (plan.width == 2) {
    // What a contraction would leave to do later has to be done in the binary tree.
    width = leaf_width_of(plan);
    parameters.set(KIWAMI_PARAMETER_CONTRACTION, KIWAMI_CONTRACTION_SURFACE_AREA);
    parameters.set(KIWAMI_PARAMETER_MAX_LEAF_SIZE, width);
  }
  // Nothing is merged, so nothing is divided to be merged.
  parameters.set(KIWAMI_PARAMETER_MERGE_LEAVES, 0);
  if (builds_wide_tree(parameters)) {
    if (plan.width == 2) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "width is 2, expected 4, 8 or 16, as builder %s makes no binary tree",
                  method_name(KIWAMI_STAGE_BUILDER, parameters.whole(KIWAMI_PARAMETER_BUILDER)));
    }
    tree_ = flatten(build_wide_draft(std::move(primitives), wide_tree_config(parameters, width),
                                     parameters, memory, parallel),
                    memory);
    return;
  }
  // Boxes hold nothing that a ray could hit: there, the areas alone guide what goes by rays.
  const Array<RepresentativeRay> rays = sample_rays_for(parameters, source(), memory);
  const BinaryBvh binary =
      build_binary_bvh(std::move(primitives), source(), {rays.data(), rays.size()}, parameters,
                       width, memory, parallel);
  if (parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) {
    primitives = collect(source());
    const TriangleSource triangles = source();
    verify_binary_bvh(binary, primitives.data(), primitives.size(),
                      binary_leaf_size_of(parameters, width), memory, &triangles);
  }
  if (plan.width == 2 || binary.nodes.empty()) {
    tree_ = flatten(binary, memory);
    return;
  }
  WideTreeConfig config = wide_tree_config(parameters, width);
  config.rays = {rays.data(), rays.size()};
  tree_ = flatten(contract_by(binary, source(), config, memory, parallel), binary, memory);
}

/// Those that no leaf owns are empty.
Array<Bounds> Bvh::boxes_by_id(const TriangleSource& source) const {
  Array<Bounds> boxes(device_->memory(), numbered_count_);
  std::fill(boxes.begin(), boxes.end(), Bounds::empty());
  for (const BuildPrimitive& primitive : collect(source)) boxes[primitive.id] = primitive.bounds();
  for (const uint32_t id : skipped_ids_) boxes[id] = Bounds::empty();
  return boxes;
}

void Bvh::refit(const BoxArray& boxes) {
  if (scene_.get()) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "the tree is that of a scene, expected one of kiwami_bvh_build");
  }
  if (boxes.count != boxes_.size()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "count is %zu, expected %zu, as many as were built",
                boxes.count, boxes_.size());
  }
  Memory& memory = device_->memory();
  const TriangleMeshView mesh = mesh_.get() ? mesh_->view(0, 0) : TriangleMeshView{};
  Array<Bounds> moved =
      is_over_boxes() ? read_boxes(boxes, memory, device_->parallel()) : boxes_by_id({&mesh, 1});
  for (const uint32_t id : tree_.primitive_ids) {
    if (!moved[id].is_empty()) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "primitive %u of the tree is now NaN, out of range or turned inside out, expected "
                "a box",
                id);
  }
  kiwami::refit(tree_.nodes, tree_.primitive_ids, moved, device_->parallel());
  if (is_over_boxes()) {
    boxes_ = std::move(moved);
  } else {
    take_vertices();
  }
}

void Bvh::validate() const {
  if (scene_.get()) scene_->validate();
  verify_flat_tree({nodes().data(), nodes().size()}, tree_.primitive_ids, boxes_by_id(source()),
                   info_.width, info_.leaf_width, device_->memory());
}

}  // namespace kiwami
