// SPDX-License-Identifier: Apache-2.0
#include "core/scene_parts.h"

#include "core/saved_scene.h"

namespace kiwami {

void SceneParts::build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan) {
  instances_.build(geometries, count, plan);
  if (instances_.can_be_hit()) views_[count_++] = instances_.part();
  if (instances_.moving().can_be_hit()) views_[count_++] = instances_.moving().part();
  for (ShapePart& part : shapes_) {
    part.build(geometries, count, plan);
    add(part.tree(), part.view());
  }
  user_.build(geometries, count, plan);
  add(user_.tree(), user_.view());
  motion_.build(geometries, count, plan);
  add(motion_.tree(), motion_.view());
}

void SceneParts::restore(const AttachedGeometry* geometries, size_t count, const SavedParts& saved,
                         const RestorePlan& plan) {
  Memory& memory = plan.memory;
  instances_.restore(geometries, count, saved, plan.width, memory);
  if (instances_.can_be_hit()) views_[count_++] = instances_.part();
  if (instances_.moving().can_be_hit()) views_[count_++] = instances_.moving().part();
  for (size_t kind = 0; kind < 3; ++kind) {
    shapes_[kind].restore(geometries, count, saved.shape_trees[kind], memory);
    if (plan.copies_primitives) shapes_[kind].copy_shapes(memory, plan.parallel);
    add(shapes_[kind].tree(), shapes_[kind].view());
  }
  motion_.restore(geometries, count, saved.motion_tree, saved.motion_bounds, memory);
  if (plan.copies_primitives) motion_.copy_triangles(memory, plan.parallel);
  add(motion_.tree(), motion_.view());
}

void SceneParts::add(const PartTree& tree, const ScenePart& view) {
  if (!tree.is_empty()) views_[count_++] = view;
}

Bounds SceneParts::bounds() const {
  Bounds bounds = user_.tree().bounds;
  bounds.extend(instances_.bounds());
  bounds.extend(motion_.tree().bounds);
  for (const ShapePart& part : shapes_) bounds.extend(part.tree().bounds);
  return bounds;
}

uint64_t SceneParts::primitive_count() const {
  uint64_t count = user_.tree().primitive_count + motion_.tree().primitive_count;
  for (const ShapePart& part : shapes_) count += part.tree().primitive_count;
  return count;
}

uint64_t SceneParts::skipped_count() const {
  uint64_t count = user_.numbered_count() + motion_.numbered_count();
  for (const ShapePart& part : shapes_) count += part.numbered_count();
  return count - primitive_count();
}

void SceneParts::validate(Memory& memory, const Parallel& parallel) const {
  instances_.validate(memory, parallel);
  for (const ShapePart& part : shapes_) part.validate(memory, parallel);
  motion_.validate(memory, parallel);
}

}  // namespace kiwami
