// SPDX-License-Identifier: Apache-2.0
#include "core/shape_part.h"

#include <cmath>

#include "core/collect_boxes.h"
#include "core/error.h"
#include "core/saved_scene.h"
#include "core/shape_blocks.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Ids have 32 bits, of which the highest one stands for none.
constexpr uint64_t kMaxShapeCount = 0xFFFFFFFEu;

GeometryKind geometry_kind_of(ShapeKind kind) {
  return kind == ShapeKind::kSphere ? GeometryKind::kSpheres
         : kind == ShapeKind::kDisc ? GeometryKind::kDiscs
                                    : GeometryKind::kCurves;
}

/// A point as its floats are, in double.
struct Ball {
  double centre[3];
  double radius;
};

/// False for one that cannot be hit. Comparisons with NaN are false.
bool read_ball(const ShapeView& view, size_t index, Ball& ball) {
  float numbers[4];
  std::memcpy(numbers, view.points + index * view.point_stride, sizeof numbers);
  for (int axis = 0; axis < 3; ++axis) {
    if (!(std::fabs(numbers[axis]) <= KIWAMI_MAX_COORDINATE)) return false;
    ball.centre[axis] = numbers[axis];
  }
  ball.radius = numbers[3];
  return numbers[3] >= 0.0f && numbers[3] <= KIWAMI_MAX_COORDINATE;
}

/// Widens the box of floats around centre - reach .. centre + reach along an axis. What the double
/// sum rounds off is a part of 2^-53 of the coordinate, which the margin of the box test has room
/// for (kernels/shape-inl.h).
void extend(Bounds& box, int axis, double centre, double reach) {
  box.lower[axis] = min_keep(box.lower[axis], round_down(centre - reach));
  box.upper[axis] = max_keep(box.upper[axis], round_up(centre + reach));
}

bool sphere_box(const ShapeView& view, uint32_t primitive, Bounds& box) {
  Ball ball;
  if (!read_ball(view, primitive, ball)) return false;
  for (int axis = 0; axis < 3; ++axis) extend(box, axis, ball.centre[axis], ball.radius);
  return true;
}

bool disc_box(const ShapeView& view, uint32_t primitive, Bounds& box) {
  Ball ball;
  float numbers[3];
  std::memcpy(numbers, view.normals + primitive * view.normal_stride, sizeof numbers);
  const double normal[3] = {numbers[0], numbers[1], numbers[2]};
  const double squared = normal[0] * normal[0] + normal[1] * normal[1] + normal[2] * normal[2];
  if (!read_ball(view, primitive, ball) || !(squared > 0.0 && std::isfinite(squared))) return false;
  for (int axis = 0; axis < 3; ++axis) {
    // The part of the radius by which a circle reaches along an axis is the sine of the angle
    // between the axis and the normal.
    const double b = normal[(axis + 1) % 3], c = normal[(axis + 2) % 3];
    const double sine = std::sqrt((b * b + c * c) / squared);
    extend(box, axis, ball.centre[axis], ball.radius * sine * (1.0 + 0x1p-40));
  }
  return true;
}

bool curve_box(const ShapeView& view, uint32_t primitive, Bounds& box) {
  size_t first = primitive;
  if (view.indices) {
    uint32_t index;
    std::memcpy(&index, view.indices + primitive * view.index_stride, sizeof index);
    first = index;
    if (first + 1 >= view.point_count) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "index %u of geometry %u is %u, expected less than its point count - 1, which is "
                  "%zu",
                  primitive, view.geometry_id, index, view.point_count - 1);
    }
  }
  Ball ball[2];
  if (!read_ball(view, first, ball[0]) || !read_ball(view, first + 1, ball[1])) return false;
  double length = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    length = std::fmax(length, std::fabs(ball[1].centre[axis] - ball[0].centre[axis]));
  }
  // What kernels/shape-inl.h allows a crossing of the cone to lie outside.
  const double tolerance = 0x1p-20 * (length + (ball[0].radius + ball[1].radius));
  for (const Ball& end : ball) {
    for (int axis = 0; axis < 3; ++axis) {
      extend(box, axis, end.centre[axis], end.radius + tolerance);
    }
  }
  return true;
}

/// A box that reaches beyond KIWAMI_MAX_COORDINATE is none.
bool is_in_range(const Bounds& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(-KIWAMI_MAX_COORDINATE <= box.lower[axis] && box.lower[axis] <= box.upper[axis] &&
          box.upper[axis] <= KIWAMI_MAX_COORDINATE)) {
      return false;
    }
  }
  return true;
}

bool make_box(ShapeKind kind, const ShapeView& view, uint32_t primitive, Bounds& box) {
  box = Bounds::empty();
  const bool is_shape = kind == ShapeKind::kSphere ? sphere_box(view, primitive, box)
                        : kind == ShapeKind::kDisc ? disc_box(view, primitive, box)
                                                   : curve_box(view, primitive, box);
  return is_shape && is_in_range(box);
}

}  // namespace

void ShapePart::number(const AttachedGeometry* geometries, size_t count, Memory& memory) {
  views_ = Array<ShapeView>(memory, count);
  uint64_t next_id = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (geometries[i].geometry->kind() != geometry_kind_of(source_.kind)) continue;
    const Shapes& shapes = static_cast<const Shapes&>(*geometries[i].geometry);
    if (shapes.count() == 0) continue;
    views_[used++] = shapes.view(static_cast<uint32_t>(next_id), geometries[i].geometry_id);
    next_id += shapes.count();
    if (next_id > kMaxShapeCount) {
      throw Error(KIWAMI_ERROR_TOO_LARGE,
                  "the scene has %llu shapes of a kind up to geometry %u, expected at most %llu",
                  static_cast<unsigned long long>(next_id), geometries[i].geometry_id,
                  static_cast<unsigned long long>(kMaxShapeCount));
    }
  }
  views_.shrink(used);
  numbered_count_ = static_cast<size_t>(next_id);
  source_ = {views_.data(), static_cast<uint32_t>(used), source_.kind, nullptr, 0};
}

void ShapePart::build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan) {
  number(geometries, count, plan.memory);
  if (views_.empty()) return;
  tree_ = build_part_tree(collect(plan.memory, plan.parallel), plan);
  if (plan.parameters.whole(KIWAMI_PARAMETER_LAYOUT) == KIWAMI_LAYOUT_COMPACT) return;
  copy_shapes(plan.memory, plan.parallel);
}

void ShapePart::restore(const AttachedGeometry* geometries, size_t count, const SavedTree* saved,
                        Memory& memory) {
  number(geometries, count, memory);
  check_saved_part("shapes", numbered_count_, saved);
  if (saved) tree_ = saved->part();
}

void ShapePart::copy_shapes(Memory& memory, const Parallel& parallel) {
  if (views_.empty()) return;
  blocks_ = make_shape_blocks(source_, tree_.tree, memory, parallel);
  source_.blocks = blocks_.data();
  source_.leaf_begin = tree_.tree.node_bytes();
}

Array<BuildPrimitive> ShapePart::collect(Memory& memory, const Parallel& parallel) const {
  const auto make_block = [this](size_t begin, size_t end, BuildPrimitive* made) {
    size_t made_count = 0;
    const ShapeView* view = views_.data();
    for (size_t id = begin; id < end; ++id) {
      while (id - view->first_id >= view->count) ++view;
      Bounds box;
      if (!make_box(source_.kind, *view, static_cast<uint32_t>(id) - view->first_id, box)) continue;
      made[made_count++] = {box.lower, static_cast<uint32_t>(id), box.upper, 0};
    }
    return made_count;
  };
  return collect_blocks(numbered_count_, memory, parallel, make_block);
}

ScenePart ShapePart::view() const {
  return {PartKind::kShapes, tree_.tree.view, &source_, std::numeric_limits<float>::infinity(),
          0.0f};
}

void ShapePart::validate(Memory& memory, const Parallel& parallel) const {
  if (views_.empty()) return;
  const Array<BuildPrimitive> boxes = collect(memory, parallel);
  verify_wide_tree(tree_.tree, {boxes.data(), boxes.size()}, memory);
}

}  // namespace kiwami
