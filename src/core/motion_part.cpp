// SPDX-License-Identifier: Apache-2.0
#include "core/motion_part.h"

#include <algorithm>
#include <cmath>

#include "core/collect_boxes.h"
#include "core/error.h"
#include "core/linear_bounds.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Ids have 32 bits, of which the highest one stands for none.
constexpr uint64_t kMaxTriangleCount = 0xFFFFFFFEu;
/// Bounds of a slot that nothing is in during a segment: they stay finite at any time between.
constexpr float kUnused = 0x1p100f;
constexpr uint32_t kMaxSegments = KIWAMI_MAX_TIME_STEPS - 1;

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

/// Throws unless every index of a triangle names a vertex.
void check_indices(const MovingMeshView& mesh, uint32_t primitive) {
  if (!mesh.indices) return;
  uint32_t corner[3];
  std::memcpy(corner, mesh.indices + primitive * mesh.index_stride, sizeof corner);
  for (uint32_t k = 0; k < 3; ++k) {
    if (corner[k] < mesh.vertex_count) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "index %u of triangle %u of geometry %u is %u, expected less than its vertex "
                "count, which is %zu",
                k, primitive, mesh.geometry_id, corner[k], mesh.vertex_count);
  }
}

/// Steps over the time of all meshes, as short as the shortest of theirs.
TimeSteps common_steps(const Array<MovingMeshView>& meshes) {
  TimeSteps steps = meshes[0].time;
  for (const MovingMeshView& mesh : meshes) {
    steps.begin = std::min(steps.begin, mesh.time.begin);
    steps.end = std::max(steps.end, mesh.time.end);
  }
  double most = 1.0;
  for (const MovingMeshView& mesh : meshes) {
    const double part =
        (double{mesh.time.end} - mesh.time.begin) / (double{steps.end} - steps.begin);
    most = std::max(most, mesh.time.segment_count / part);
  }
  steps.segment_count = static_cast<uint32_t>(std::min(std::ceil(most), double{kMaxSegments}));
  return steps;
}

const MovingMeshView& mesh_of(const MotionPart& part, uint32_t id) {
  return *(std::upper_bound(part.meshes, part.meshes + part.mesh_count, id,
                            [](uint32_t a, const MovingMeshView& b) { return a < b.first_id; }) -
           1);
}

/// Walks a tree from its leaves up, for one segment of time.
template <int N>
class BoundsFiller {
 public:
  BoundsFiller(const WideTree& tree, const MotionPart& part, const Bounds& extent, uint32_t segment,
               MotionBounds<N>* bounds)
      : tree_(tree), part_(part), extent_(extent), segment_(segment), bounds_(bounds) {}

  /// What is below a reference; writes the bounds of all nodes below.
  LinearBounds fill(ChildReference reference) {
    LinearBounds below;
    if (reference.is_leaf()) {
      const uint32_t* ids = tree_.leaf_ids(tree_.number_of(reference));
      for (uint32_t lane = 0; lane < N; ++lane) {
        if (((reference.mask() >> lane) & 1u) != 0) below.extend(of_triangle(ids[lane]));
      }
      return below;
    }
    const WideNode<N>& node = tree_.nodes<N>()[tree_.number_of(reference)];
    for (uint32_t slot = 0; slot < N; ++slot) {
      if (((reference.mask() >> slot) & 1u) == 0) continue;
      below.extend(fill_slot(reference, slot, node.child[slot]));
    }
    return below;
  }

  /// The same of one slot of a node.
  LinearBounds fill_slot(ChildReference node, uint32_t slot, ChildReference child) {
    const LinearBounds below = fill(child);
    MotionBounds<N>& target = bounds_[tree_.number_of(node)];
    write(target.bounds[0], slot, below.start);
    write(target.bounds[1], slot, below.end);
    return below;
  }

  static void clear(MotionBounds<N>& bounds) {
    for (auto& at_time : bounds.bounds) {
      for (auto& axis : at_time) {
        std::fill_n(axis[0], N, kUnused);
        std::fill_n(axis[1], N, -kUnused);
      }
    }
  }

 private:
  LinearBounds of_triangle(uint32_t id) const {
    const MovingMeshView& mesh = mesh_of(part_, id);
    return linear_bounds_of(mesh, id - mesh.first_id, part_.time, segment_, extent_);
  }

  void write(float (&bounds)[3][2][N], uint32_t slot, const Bounds& box) const {
    if (box.is_empty()) return;
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = tree_.view.centre[axis];
      bounds[axis][0][slot] = subtract_down(box.lower[axis], centre);
      bounds[axis][1][slot] = subtract_up(box.upper[axis], centre);
    }
  }

  const WideTree& tree_;
  const MotionPart& part_;
  const Bounds& extent_;
  uint32_t segment_;
  MotionBounds<N>* bounds_;
};

/// Walks a tree from its leaves up, at one time.
template <int N>
class BoundsChecker {
 public:
  BoundsChecker(const WideTree& tree, const MotionPart& part, float time)
      : tree_(tree), part_(part), time_(time) {
    if (!place_in_time(part.time, time, place_)) {
      throw Error(KIWAMI_ERROR_VALIDATION, "time %g lies outside of the moving meshes' own",
                  double{time});
    }
  }

  /// The box of all triangles below at the time. Throws where a box does not hold those below it.
  Bounds check(ChildReference reference) const {
    Bounds below = Bounds::empty();
    for (uint32_t i = 0; i < N; ++i) {
      if (((reference.mask() >> i) & 1u) == 0) continue;
      below.extend(reference.is_leaf() ? of_triangle(tree_.leaf_ids(tree_.number_of(reference))[i])
                                       : check_slot(reference, i));
    }
    return below;
  }

 private:
  Bounds check_slot(ChildReference node, uint32_t slot) const {
    const uint64_t number = tree_.number_of(node);
    const Bounds below = check(tree_.nodes<N>()[number].child[slot]);
    if (below.is_empty()) return below;
    const auto& bounds = reinterpret_cast<const MotionBounds<N>*>(
                             part_.bounds)[place_.segment * part_.node_count + number]
                             .bounds;
    const float f = place_.fraction;
    for (int axis = 0; axis < 3; ++axis) {
      const auto at = [&](int side) {
        return (1.0f - f) * bounds[0][axis][side][slot] + f * bounds[1][axis][side][slot];
      };
      const float centre = tree_.view.centre[axis];
      if (at(0) <= subtract_down(below.lower[axis], centre) &&
          subtract_up(below.upper[axis], centre) <= at(1)) {
        continue;
      }
      throw Error(KIWAMI_ERROR_VALIDATION,
                  "slot %u of node %llu does not hold the triangles below it at the time %g", slot,
                  static_cast<unsigned long long>(number), double{time_});
    }
    return below;
  }

  Bounds of_triangle(uint32_t id) const {
    const MovingMeshView& mesh = mesh_of(part_, id);
    Bounds box = Bounds::empty();
    TimePlace place;
    if (!place_in_time(mesh.time, time_, place)) return box;
    Vec3f corner[3];
    corners_at(mesh, id - mesh.first_id, place, corner);
    for (const Vec3f& vertex : corner) box.extend(vertex);
    return box;
  }

  const WideTree& tree_;
  const MotionPart& part_;
  float time_;
  TimePlace place_{};
};

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
  Bounds extent;
  tree_ = build_part_tree(collect(plan.memory, plan.parallel, extent), plan);
  tree_.bounds = extent;
  data_.meshes = meshes_.data();
  data_.mesh_count = static_cast<uint32_t>(meshes_.size());
  data_.time = common_steps(meshes_);
  data_.node_count = tree_.tree.node_count;
  data_.scene.ranges = ranges_.data();
  data_.scene.range_count = static_cast<uint32_t>(ranges_.size());
  if (plan.width == 4) fill_bounds<4>(plan.memory, plan.parallel);
  if (plan.width == 8) fill_bounds<8>(plan.memory, plan.parallel);
  if (plan.width == 16) fill_bounds<16>(plan.memory, plan.parallel);
  data_.bounds = bounds_.data();
  if (plan.parameters.whole(KIWAMI_PARAMETER_VALIDATE_BUILD) != 0) {
    validate(plan.memory, plan.parallel);
  }
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
      check_indices(*mesh, primitive);
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

template <int N>
void MotionTree::fill_bounds(Memory& memory, const Parallel& parallel) {
  WideTree& tree = tree_.tree;
  const uint64_t node_count = tree.node_count;
  bounds_ =
      Array<unsigned char>(memory, data_.time.segment_count * node_count * sizeof(MotionBounds<N>));
  auto* const bounds = reinterpret_cast<MotionBounds<N>*>(bounds_.data());
  const ChildReference root = tree.view.root;
  if (root.mask() == 0) return;
  // Also of a leaf at the root. All boxes are in that of all times, which padding widens by a part
  // of the same numbers.
  for (int axis = 0; axis < 3; ++axis) {
    const double centre = tree.view.centre[axis];
    const double lower = tree_.bounds.lower[axis], upper = tree_.bounds.upper[axis];
    const double reach = std::max(std::fabs(lower - centre), std::fabs(upper - centre));
    const double greatest = std::max(std::fabs(lower), std::fabs(upper));
    tree.view.greatest_bound[axis] = round_up(reach + 0x1p-20 * (greatest + (upper - lower)));
  }
  if (root.is_leaf()) return;
  parallel.for_blocks(data_.time.segment_count * node_count, 1024, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) BoundsFiller<N>::clear(bounds[i]);
  });
  const WideNode<N>& node = tree.nodes<N>()[tree.number_of(root)];
  // One task a child of the root and a segment.
  parallel.for_each(size_t{N} * data_.time.segment_count, [&](size_t task) {
    const auto slot = static_cast<uint32_t>(task % N), segment = static_cast<uint32_t>(task / N);
    if (((root.mask() >> slot) & 1u) == 0) return;
    BoundsFiller<N>(tree, data_, tree_.bounds, segment, bounds + segment * node_count)
        .fill_slot(root, slot, node.child[slot]);
  });
}

template <int N>
void MotionTree::check_bounds(const Parallel& parallel) const {
  const ChildReference root = tree_.tree.view.root;
  if (root.mask() == 0 || root.is_leaf()) return;
  // The steps, and between them.
  constexpr float parts[] = {0.0f, 0.3f, 0.5f, 0.9f};
  const TimeSteps& time = data_.time;
  parallel.for_each(size_t{4} * time.segment_count, [&](size_t i) {
    const size_t segment = i / 4;
    const float place = static_cast<float>(segment) + parts[i % 4];
    const float at =
        time.begin + (time.end - time.begin) * (place / static_cast<float>(time.segment_count));
    BoundsChecker<N>(tree_.tree, data_, std::min(at, time.end)).check(root);
  });
  BoundsChecker<N>(tree_.tree, data_, time.end).check(root);
}

void MotionTree::validate(Memory& memory, const Parallel& parallel) const {
  if (meshes_.empty()) return;
  Bounds extent;
  const Array<BuildPrimitive> boxes = collect(memory, parallel, extent);
  verify_wide_tree(tree_.tree, {boxes.data(), boxes.size()}, memory);
  if (tree_.tree.width == 4) check_bounds<4>(parallel);
  if (tree_.tree.width == 8) check_bounds<8>(parallel);
  if (tree_.tree.width == 16) check_bounds<16>(parallel);
}

ScenePart MotionTree::view() const {
  return {PartKind::kMovingTriangles, tree_.tree.view, &data_,
          std::numeric_limits<float>::infinity(), 0.0f};
}

}  // namespace kiwami
