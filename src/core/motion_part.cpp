// SPDX-License-Identifier: Apache-2.0
#include "core/motion_part.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/collect_boxes.h"
#include "core/error.h"
#include "core/motion_blocks.h"
#include "core/saved_scene.h"

namespace kiwami {
namespace {

/// Ids have 32 bits, of which the highest one stands for none.
constexpr uint64_t kMaxTriangleCount = 0xFFFFFFFEu;

bool is_in_range(const Bounds& box) {
  // Comparisons with NaN are false, but a box keeps none: see is_finite.
  for (int axis = 0; axis < 3; ++axis) {
    if (!(-KIWAMI_MAX_COORDINATE <= box.lower[axis] && box.upper[axis] <= KIWAMI_MAX_COORDINATE)) {
      return false;
    }
  }
  return true;
}

bool is_finite(const Vec3f corner[3]) {
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(corner[k][axis])) return false;
    }
  }
  return true;
}

/// The mean of a triangle's boxes at all steps, and the box of all; false where it can never be
/// hit.
bool average(const MovingMeshView& mesh, uint32_t primitive, Bounds& mean, Bounds& all) {
  double lower[3] = {}, upper[3] = {};
  all = Bounds::empty();
  const uint32_t step_count = mesh.time.segment_count + 1;
  for (uint32_t step = 0; step < step_count; ++step) {
    Vec3f corner[3];
    corners_at(mesh, primitive, step, corner);
    const Bounds box = box_at(mesh, primitive, step);
    if (!is_finite(corner) || !is_in_range(box)) return false;
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] += box.lower[axis];
      upper[axis] += box.upper[axis];
    }
    all.extend(box);
  }
  for (int axis = 0; axis < 3; ++axis) {
    mean.lower[axis] = static_cast<float>(lower[axis] / step_count);
    mean.upper[axis] = static_cast<float>(upper[axis] / step_count);
  }
  return true;
}

}  // namespace

void MotionTree::number(const AttachedGeometry* geometries, size_t count, Memory& memory) {
  meshes_ = Array<MovingMeshView>(memory, count);
  ranges_ = Array<GeometryRange>(memory, count);
  uint64_t next_id = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (geometries[i].geometry->kind() != GeometryKind::kMovingMesh) continue;
    const auto& mesh = static_cast<const MovingMesh&>(*geometries[i].geometry);
    if (mesh.triangle_count() == 0) continue;
    const auto first_id = static_cast<uint32_t>(next_id);
    next_id += mesh.triangle_count();
    if (next_id > kMaxTriangleCount) {
      throw Error(KIWAMI_ERROR_TOO_LARGE,
                  "the scene has %llu moving triangles up to geometry %u, expected at most %llu",
                  static_cast<unsigned long long>(next_id), geometries[i].geometry_id,
                  static_cast<unsigned long long>(kMaxTriangleCount));
    }
    meshes_[used] = mesh.view(first_id, geometries[i].geometry_id);
    ranges_[used] = {first_id, geometries[i].geometry_id, mesh.mask()};
    if (mesh.mask() != ~uint32_t{0}) data_.scene.has_masks = 1;
    ++used;
  }
  meshes_.shrink(used);
  ranges_.shrink(used);
  numbered_count_ = static_cast<size_t>(next_id);
}

void MotionTree::build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan) {
  number(geometries, count, plan.memory);
  if (meshes_.empty()) return;
  const TimeSteps time = show(plan.memory);
  Array<BuildPrimitive> boxes = collect(plan.memory, plan.parallel, extent_);
  tree_.build(std::move(boxes), extent_, time, *this, plan);
  data_.boxes = tree_.boxes();
  if (plan.parameters.whole(KIWAMI_PARAMETER_LAYOUT) != KIWAMI_LAYOUT_COMPACT) {
    copy_triangles(plan.memory, plan.parallel);
  }
  if (plan.parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) {
    validate(plan.memory, plan.parallel);
  }
}

void MotionTree::copy_triangles(Memory& memory, const Parallel& parallel) {
  if (meshes_.empty() || !may_have_blocks(data_)) return;
  const WideTree& tree = tree_.tree().tree;
  blocks_ = make_motion_blocks(data_, tree, memory, parallel);
  data_.blocks = blocks_.data();
  data_.leaf_begin = tree.node_bytes();
}

TimeSteps MotionTree::show(Memory& memory) {
  data_.meshes = meshes_.data();
  data_.mesh_count = static_cast<uint32_t>(meshes_.size());
  data_.scene.ranges = ranges_.data();
  data_.scene.range_count = static_cast<uint32_t>(ranges_.size());
  Array<TimeSteps> times(memory, meshes_.size());
  for (size_t i = 0; i < meshes_.size(); ++i) times[i] = meshes_[i].time;
  return common_steps(times.data(), times.size());
}

void MotionTree::restore(const AttachedGeometry* geometries, size_t count, const SavedTree* saved,
                         std::span<const unsigned char> bounds, Memory& memory) {
  number(geometries, count, memory);
  check_saved_part("moving triangles", numbered_count_, saved);
  if (!saved) return;
  const TimeSteps time = show(memory);
  extent_ = saved->bounds;
  tree_.restore(*saved, time, bounds);
  data_.boxes = tree_.boxes();
}

Array<BuildPrimitive> MotionTree::collect(Memory& memory, const Parallel& parallel,
                                          Bounds& extent) const {
  Array<Bounds> extents(memory, blocks_of(numbered_count_));
  const auto make_block = [&](size_t begin, size_t end, BuildPrimitive* made) {
    size_t made_count = 0;
    const MovingMeshView* mesh = meshes_.data();
    Bounds block = Bounds::empty();
    for (size_t id = begin; id < end; ++id) {
      while (id - mesh->first_id >= mesh->triangle_count) ++mesh;
      const uint32_t primitive = static_cast<uint32_t>(id) - mesh->first_id;
      uint32_t index[3];
      first_step_of(*mesh).checked_indices_of(primitive, index);
      Bounds mean, all;
      if (!average(*mesh, primitive, mean, all)) continue;
      made[made_count++] = {mean.lower, static_cast<uint32_t>(id), mean.upper, 0};
      block.extend(all);
    }
    extents[begin / kCollectedBlock] = block;
    return made_count;
  };
  Array<BuildPrimitive> boxes = collect_blocks(numbered_count_, memory, parallel, make_block);
  extent = Bounds::empty();
  for (const Bounds& block : extents) extent.extend(block);
  return boxes;
}

LinearBounds MotionTree::during(uint32_t id, const TimeSteps& steps, uint32_t segment) const {
  const MovingMeshView& mesh = mesh_of(data_, id);
  return linear_bounds_of(mesh, id - mesh.first_id, steps, segment, extent_);
}

Bounds MotionTree::at(uint32_t id, float time) const {
  const MovingMeshView& mesh = mesh_of(data_, id);
  Bounds box = Bounds::empty();
  TimePlace place;
  if (!place_in_time(mesh.time, time, place)) return box;
  Vec3f corner[3];
  corners_at(mesh, id - mesh.first_id, place, corner);
  for (const Vec3f& vertex : corner) box.extend(vertex);
  return box;
}

void MotionTree::validate(Memory& memory, const Parallel& parallel) const {
  if (meshes_.empty()) return;
  Bounds extent;
  const Array<BuildPrimitive> boxes = collect(memory, parallel, extent);
  tree_.validate(boxes, *this, memory, parallel);
}

ScenePart MotionTree::view() const {
  return {PartKind::kMovingTriangles, tree_.tree().tree.view, &data_,
          std::numeric_limits<float>::infinity(), 0.0f};
}

}  // namespace kiwami
