// SPDX-License-Identifier: Apache-2.0
#include "core/scene_instances.h"

#include <algorithm>
#include <atomic>
#include <bit>

#include "core/committed_scene.h"
#include "core/error.h"
#include "core/saved_scene.h"
#include "core/scene.h"
#include "math/rounding.h"
#include "wide/slot_owners.h"

namespace kiwami {
namespace {

/// Instances that one task looks at.
constexpr size_t kBlockSize = 4096;
/// Numbers are 32 bits wide, and their highest value names nothing.
constexpr uint64_t kMaxInstanceCount = 0xFFFFFFFEu;

using ull = unsigned long long;

/// Calls visit(instances, geometry_id) for each geometry that is instances.
template <typename Visit>
void for_each_instances(const AttachedGeometry* geometries, size_t count, Visit&& visit) {
  for (size_t i = 0; i < count; ++i) {
    if (geometries[i].geometry->kind() != GeometryKind::kInstances) continue;
    visit(static_cast<const Instances&>(*geometries[i].geometry), geometries[i].geometry_id);
  }
}

CommittedScene& committed_scene_of(const Instances& instances, uint32_t index, uint32_t geometry_id,
                                   uint32_t width) {
  CommittedScene* const scene = instances.scene(index).committed();
  if (!scene) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "scene %u of geometry %u was never committed, expected a successful "
                "kiwami_scene_commit before",
                index, geometry_id);
  }
  if (scene->width() != width) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "scene %u of geometry %u has %u children a node, expected %u as the scene that "
                "instances it",
                index, geometry_id, scene->width(), width);
  }
  if (scene->instance_depth() >= KIWAMI_MAX_INSTANCE_DEPTH) {
    throw Error(KIWAMI_ERROR_TOO_LARGE,
                "scene %u of geometry %u has paths of %u instances, expected at most %d here",
                index, geometry_id, scene->instance_depth(), KIWAMI_MAX_INSTANCE_DEPTH - 1);
  }
  return *scene;
}

/// The boxes of references, numbered as leaves name them: by their position, or their instance.
Array<BuildPrimitive> boxes_of(const Array<BraidReference>& references, bool has_starts,
                               Memory& memory) {
  Array<BuildPrimitive> boxes(memory, references.size());
  for (size_t i = 0; i < references.size(); ++i) {
    const uint32_t id = has_starts ? static_cast<uint32_t>(i) : references[i].start.instance;
    boxes[i] = {references[i].box.lower, id, references[i].box.upper, 0};
  }
  return boxes;
}

/// An instance costs as much as a whole tree, so each has a box of its own. Triangles alone can be
/// cut.
SceneParameters for_instances(SceneParameters parameters) {
  parameters.set(KIWAMI_PARAMETER_MAX_LEAF_SIZE, 1);
  if (parameters.whole(KIWAMI_PARAMETER_BUILDER) == KIWAMI_BUILDER_SPATIAL_SPLIT) {
    parameters.set(KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_BINNED_SAH);
  }
  return parameters;
}

}  // namespace

/// What one instance shows: the box of it, and the error of hits there.
struct SceneInstances::Extent {
  Affine forward;
  Bounds inner;   ///< in the space of its scene; empty: nothing
  Bounds bounds;  ///< in the outer space
  HitError error;
};

SceneInstances::~SceneInstances() {
  for (CommittedScene* scene : scenes_) scene->release();
}

void SceneInstances::build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan) {
  width_ = plan.width;
  collect_prototypes(geometries, count, plan.width, plan.memory);
  if (prototypes_.empty()) return;
  fill_records(geometries, count, plan.memory, plan.parallel);
  measure(plan.memory, plan.parallel);
  set_rebraiding(plan.parameters.whole(KIWAMI_PARAMETER_REBRAID),
                 plan.parameters[KIWAMI_PARAMETER_REBRAID_BUDGET]);
  const Array<BraidReference> references = make_references(plan.memory, plan.parallel);
  if (rebraid_mode_ != KIWAMI_REBRAID_OFF) {
    starts_ = Array<InstanceStart>(plan.memory, references.size());
    for (size_t i = 0; i < references.size(); ++i) starts_[i] = references[i].start;
  }
  show();
  const SceneParameters parameters = for_instances(plan.parameters);
  const PartPlan own_plan{parameters, plan.width, plan.memory, plan.parallel};
  tree_ = build_part_tree(boxes_of(references, !starts_.empty(), plan.memory), own_plan);
  moving_.build(data_, scenes_.data(), own_plan);
}

void SceneInstances::set_rebraiding(uint32_t mode, double budget) {
  rebraid_mode_ = mode;
  rebraid_config_.opens_roots_only = mode == KIWAMI_REBRAID_ROOTS;
  rebraid_config_.budget = budget;
}

void SceneInstances::show() {
  data_ = {records_.data(), prototypes_.data(), masks_.empty() ? nullptr : masks_.data(),
           starts_.empty() ? nullptr : starts_.data()};
}

SavedInstances SceneInstances::saved() const {
  return {{records_.data(), records_.size()},
          {masks_.data(), masks_.size()},
          {starts_.data(), starts_.size()},
          bounds_,
          error_,
          far_origin_,
          rebraid_mode_,
          rebraid_config_.budget,
          moving_.saved()};
}

void SceneInstances::restore(const AttachedGeometry* geometries, size_t count,
                             const SavedParts& saved, uint32_t width, Memory& memory) {
  width_ = width;
  collect_prototypes(geometries, count, width, memory);
  const SavedInstances& from = saved.instances;
  const uint64_t instance_count = place_moving(geometries, count, from.moving, memory);
  const bool is_rebraided = from.rebraid_mode != KIWAMI_REBRAID_OFF;
  const uint64_t leaf_count = is_rebraided ? from.starts.size() : instance_count;
  const SavedTree* const tree = saved.instance_tree;
  if (instance_count > kMaxInstanceCount || from.records.size() != instance_count ||
      (!from.masks.empty() && from.masks.size() != instance_count) ||
      (tree != nullptr) != (instance_count != 0) || (!tree && saved.moving_instance_tree) ||
      (tree && tree->primitive_count > leaf_count) || (!is_rebraided && !from.starts.empty())) {
    throw Error(KIWAMI_ERROR_INVALID_FILE,
                "the scene has %llu instances, %zu records, %zu masks and %zu starts of them, and "
                "a tree of %llu, expected as many of all that there are",
                ull{instance_count}, from.records.size(), from.masks.size(), from.starts.size(),
                ull{tree ? tree->primitive_count : 0});
  }
  if (!tree) return;
  set_rebraiding(from.rebraid_mode, from.rebraid_budget);
  const auto borrow = [](auto span) {
    using Element = std::remove_const_t<typename decltype(span)::element_type>;
    return Array<Element>::borrow(const_cast<Element*>(span.data()), span.size());
  };
  records_ = borrow(from.records);
  masks_ = borrow(from.masks);
  starts_ = borrow(from.starts);
  bounds_ = from.bounds;
  error_ = from.error;
  far_origin_ = from.far_origin;
  tree_ = tree->part();
  show();
  moving_.restore(data_, from.moving, saved.moving_instance_tree, memory);
}

uint64_t SceneInstances::place_moving(const AttachedGeometry* geometries, size_t count,
                                      const SavedMovingInstances& saved, Memory& memory) {
  uint64_t instance_count = 0;
  size_t moving_count = 0, step_floats = 0;
  for_each_instances(geometries, count, [&](const Instances& instances, uint32_t) {
    instance_count += instances.count();
    if (!instances.is_moving()) return;
    ++moving_count;
    step_floats += MovingInstances::step_floats_of(instances);
  });
  if (step_floats != saved.steps.size() || moving_count != saved.regular.size()) {
    throw Error(KIWAMI_ERROR_INVALID_FILE,
                "the steps of %zu arrays of instances have %zu numbers, expected %zu of %zu",
                saved.regular.size(), saved.steps.size(), step_floats, moving_count);
  }
  moving_.borrow(saved, memory);
  uint64_t first = 0;
  for_each_instances(geometries, count, [&](const Instances& instances, uint32_t) {
    if (instances.is_moving()) moving_.place(instances, static_cast<uint32_t>(first));
    first += instances.count();
  });
  return instance_count;
}

void SceneInstances::collect_prototypes(const AttachedGeometry* geometries, size_t count,
                                        uint32_t width, Memory& memory) {
  size_t prototype_count = 0;
  for_each_instances(geometries, count, [&](const Instances& instances, uint32_t) {
    prototype_count += instances.scene_count();
  });
  prototypes_ = Array<Prototype>(memory, prototype_count);
  Array<CommittedScene*> scenes(memory, prototype_count);
  size_t used = 0;
  for_each_instances(geometries, count, [&](const Instances& instances, uint32_t geometry_id) {
    for (uint32_t i = 0; i < instances.scene_count(); ++i) {
      CommittedScene& scene = committed_scene_of(instances, i, geometry_id, width);
      prototypes_[used] = {&scene.view(), instances.mask()};
      scenes[used++] = &scene;
      depth_ = std::max(depth_, scene.instance_depth() + 1);
    }
  });
  for (CommittedScene* scene : scenes) scene->retain();
  scenes_ = std::move(scenes);
}

void SceneInstances::fill_records(const AttachedGeometry* geometries, size_t count, Memory& memory,
                                  const Parallel& parallel) {
  uint64_t record_count = 0;
  size_t moving_count = 0, step_floats = 0;
  bool has_masks = false;
  for_each_instances(geometries, count, [&](const Instances& instances, uint32_t geometry_id) {
    record_count += instances.count();
    has_masks = has_masks || instances.has_masks();
    if (instances.is_moving()) {
      ++moving_count;
      step_floats += MovingInstances::step_floats_of(instances);
    }
    if (record_count <= kMaxInstanceCount) return;
    throw Error(KIWAMI_ERROR_TOO_LARGE,
                "the scene has %llu instances up to geometry %u, expected at most %llu",
                ull{record_count}, geometry_id, ull{kMaxInstanceCount});
  });
  records_ = Array<InstanceRecord>(memory, static_cast<size_t>(record_count));
  if (has_masks) masks_ = Array<uint32_t>(memory, static_cast<size_t>(record_count));
  moving_.reserve(memory, moving_count, step_floats);
  size_t first = 0;
  uint32_t first_prototype = 0;
  for_each_instances(geometries, count, [&](const Instances& instances, uint32_t) {
    std::atomic<bool> is_faulty{false};
    parallel.for_blocks(instances.count(), kBlockSize, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        const auto instance = static_cast<uint32_t>(i);
        const uint32_t scene_index = instances.scene_index(instance);
        InstanceRecord& record = records_[first + i];
        record = {};
        if (scene_index >= instances.scene_count() ||
            !(instances.is_moving() || instances.invert(instance, record.column))) {
          is_faulty.store(true, std::memory_order_relaxed);
          return;
        }
        record.prototype = first_prototype + scene_index;
        if (has_masks) masks_[first + i] = instances.instance_mask(instance);
      }
    });
    if (instances.is_moving() && !moving_.add(instances, static_cast<uint32_t>(first), parallel)) {
      is_faulty.store(true);
    }
    // Shared buffers may have changed since they were checked.
    if (is_faulty.load()) instances.check_instances();
    first += instances.count();
    first_prototype += instances.scene_count();
  });
}

SceneInstances::Extent SceneInstances::extent_of(uint32_t instance) const {
  const InstanceRecord& record = records_[instance];
  const CommittedScene& scene = *scenes_[record.prototype];
  Extent extent;
  extent.inner = extent.bounds = scene.bounds();
  if (extent.inner.is_empty()) return extent;
  extent.forward = transform_of(record.column).forward;
  extent.bounds = image_of(extent.forward, extent.inner, 0.0);
  extent.error = HitError::through(record.column, scene.hit_error(), extent.bounds);
  return extent;
}

void SceneInstances::measure(Memory& memory, const Parallel& parallel) {
  struct Sum {
    Bounds bounds;
    HitError error;
  };
  Array<Sum> sums(memory, (records_.size() + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(records_.size(), kBlockSize, [&](size_t begin, size_t end) {
    Sum sum{Bounds::empty(), {}};
    for (size_t i = begin; i < end; ++i) {
      if (moving_.contains(static_cast<uint32_t>(i))) continue;
      const Extent extent = extent_of(static_cast<uint32_t>(i));
      sum.bounds.extend(extent.bounds);
      sum.error.extend(extent.error);
    }
    sums[begin / kBlockSize] = sum;
  });
  for (const Sum& sum : sums) {
    bounds_.extend(sum.bounds);
    error_.extend(sum.error);
  }
  if (!bounds_.is_empty()) far_origin_ = static_cast<float>(2.0 * greatest_coordinate(bounds_));
}

/// The trees of the shown scenes, in the space of the outer one.
class SceneInstances::Trees final : public BraidSource {
 public:
  explicit Trees(const SceneInstances& all) : all_(all) {}

  /// Of a whole instance, with an empty box.
  static BraidReference nothing_of(uint32_t instance) {
    return {Bounds::empty(), {instance, InstanceStart::kAllTrees, {}}, 0.0f, true};
  }

  /// Of a whole instance; its box is empty where it shows nothing.
  BraidReference root_of(uint32_t instance) const {
    const CommittedScene& scene = scene_of(instance);
    BraidReference root = nothing_of(instance);
    root.weight = static_cast<float>(std::max<uint64_t>(scene.primitive_count(), 1));
    const Extent extent = all_.extent_of(instance);
    if (!extent.inner.is_empty()) root.box = box_of(extent, extent.inner);
    return root;
  }

  uint32_t open(const BraidReference& reference,
                BraidReference (&children)[kMaxChildren]) const override {
    const Extent extent = all_.extent_of(reference.start.instance);
    const SceneView& view = scene_of(reference.start.instance).view();
    if (reference.start.tree == InstanceStart::kAllTrees) {
      // A scene of one tree is opened to the children of its root at once.
      if (view.part_count == 0)
        return open_tree(reference, extent, view, 0, view.tree.root, children);
      if (view.tree.root.mask() == 0 && view.part_count == 1) {
        return open_tree(reference, extent, view, 1, view.parts[0].tree.root, children);
      }
      return open_trees(reference, extent, view, children);
    }
    return open_tree(reference, extent, view, reference.start.tree, reference.start.subtree,
                     children);
  }

 private:
  const CommittedScene& scene_of(uint32_t instance) const {
    return *all_.scenes_[all_.records_[instance].prototype];
  }

  /// The image of a box of the scene, with room for the error of hits.
  Bounds box_of(const Extent& extent, const Bounds& inner) const {
    return image_of(extent.forward, inner, extent.error.margin(double{all_.far_origin_}));
  }

  uint32_t open_trees(const BraidReference& reference, const Extent& extent, const SceneView& view,
                      BraidReference (&children)[kMaxChildren]) const {
    uint32_t count = 0;
    const auto add = [&](const TreeView& tree, uint32_t number) {
      Bounds box;
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = next_down(tree.centre[axis] - tree.greatest_bound[axis]);
        box.upper[axis] = next_up(tree.centre[axis] + tree.greatest_bound[axis]);
      }
      children[count++] = {box_of(extent, box),
                           {reference.start.instance, number, tree.root},
                           reference.weight,
                           false};
    };
    if (view.tree.root.mask() != 0) add(view.tree, 0);
    for (uint32_t i = 0; i < view.part_count; ++i) add(view.parts[i].tree, i + 1);
    share_weight(reference, children, count);
    return count;
  }

  /// Opens a node of one of the scene's trees, by the number that references have for it: 0 is that
  /// of the triangles, i + 1 that of part i. Where things move, the boxes of nodes are those of
  /// the middle of their way, and hold them at no other time: their tree stays whole.
  uint32_t open_tree(const BraidReference& reference, const Extent& extent, const SceneView& view,
                     uint32_t number, ChildReference subtree,
                     BraidReference (&children)[kMaxChildren]) const {
    if (number != 0 && has_moving_boxes(view.parts[number - 1].kind)) return 0;
    return open_node(reference, extent, number == 0 ? view.tree : view.parts[number - 1].tree,
                     number, subtree, children);
  }

  uint32_t open_node(const BraidReference& reference, const Extent& extent, const TreeView& tree,
                     uint32_t number, ChildReference subtree,
                     BraidReference (&children)[kMaxChildren]) const {
    if (subtree.is_leaf()) return 0;
    uint32_t count = 0;
    with_width(all_.width_, [&](auto width) {
      const auto& node = node_at<width>(tree.memory, subtree);
      for (uint32_t mask = subtree.mask(); mask != 0; mask &= mask - 1) {
        const int slot = std::countr_zero(mask);
        Bounds box;
        for (int axis = 0; axis < 3; ++axis) {
          box.lower[axis] = next_down(node.bounds[axis][0][slot] + tree.centre[axis]);
          box.upper[axis] = next_up(node.bounds[axis][1][slot] + tree.centre[axis]);
        }
        children[count++] = {box_of(extent, box),
                             {reference.start.instance, number, node.child[slot]},
                             reference.weight,
                             false};
      }
    });
    share_weight(reference, children, count);
    return count;
  }

  /// By area: what it is among children is not known.
  static void share_weight(const BraidReference& reference,
                           BraidReference (&children)[kMaxChildren], uint32_t count) {
    double sum = 0.0;
    for (uint32_t i = 0; i < count; ++i) sum += double{children[i].box.half_area()};
    for (uint32_t i = 0; i < count; ++i) {
      const double share = sum > 0.0 ? double{children[i].box.half_area()} / sum : 1.0 / count;
      children[i].weight = static_cast<float>(double{reference.weight} * share);
    }
  }

  const SceneInstances& all_;
};

/// Of the instances that rest and show something, by rising number; or what they are opened into.
Array<BraidReference> SceneInstances::make_references(Memory& memory,
                                                      const Parallel& parallel) const {
  const Trees trees(*this);
  Array<BraidReference> references(memory, records_.size());
  parallel.for_blocks(records_.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const auto instance = static_cast<uint32_t>(i);
      references[i] =
          moving_.contains(instance) ? trees.nothing_of(instance) : trees.root_of(instance);
    }
  });
  size_t used = 0;
  for (const BraidReference& reference : references) {
    if (!reference.box.is_empty()) references[used++] = reference;
  }
  references.shrink(used);
  if (rebraid_mode_ == KIWAMI_REBRAID_OFF) return references;
  return rebraid(std::move(references), trees, rebraid_config_, memory);
}

ScenePart SceneInstances::part() const {
  return {PartKind::kInstances, tree_.tree.view, &data_, far_origin_, far_origin_margin_of(error_)};
}

void SceneInstances::validate(Memory& memory, const Parallel& parallel) const {
  moving_.validate(scenes_.data(), memory, parallel);
  if (!can_be_hit()) return;
  const Array<BraidReference> references = make_references(memory, parallel);
  const Array<BuildPrimitive> boxes = boxes_of(references, !starts_.empty(), memory);
  verify_wide_tree(tree_.tree, {boxes.data(), boxes.size()}, memory);
}

}  // namespace kiwami
