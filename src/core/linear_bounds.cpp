// SPDX-License-Identifier: Apache-2.0
#include "core/linear_bounds.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "math/rounding.h"

namespace kiwami {
namespace {

/// What a moving vertex and a moving box are off by, in parts of the greatest number that goes into
/// them: 1 - f, two products and a sum, of which each is rounded once (2^-24), make 3 * 2^-24; the
/// rest is room for their products and for the padding's own rounding.
constexpr double kMotionRounding = 0x1p-22;
/// The same of denormal numbers, which are off by half the least one, 2^-149, each time.
constexpr double kLeastRounding = 0x1p-146;

/// By so much of a segment a mesh's own time may differ from that of steps that are not its own:
/// both are quotients and products of three roundings, of numbers that are at most 128 segments.
constexpr double kTimeRounding = 0x1p-12;

double time_of(const TimeSteps& steps, double segment) {
  return steps.begin + (double{steps.end} - steps.begin) * (segment / steps.segment_count);
}

/// The box of a triangle at a place among its mesh's steps, 0 to segment_count, wider by a margin.
Bounds box_at(const MovingMeshView& mesh, uint32_t primitive, double place, double margin) {
  const auto step = std::min(static_cast<uint32_t>(place), mesh.time.segment_count - 1);
  const double of_end = place - step, of_start = 1.0 - of_end;
  Vec3f a[3], b[3];
  corners_at(mesh, primitive, step, a);
  corners_at(mesh, primitive, step + 1, b);
  Bounds box;
  for (int axis = 0; axis < 3; ++axis) {
    double at[3];
    for (int k = 0; k < 3; ++k) at[k] = of_start * a[k][axis] + of_end * b[k][axis];
    box.lower[axis] = round_down(std::min(std::min(at[0], at[1]), at[2]) - margin);
    box.upper[axis] = round_up(std::max(std::max(at[0], at[1]), at[2]) + margin);
  }
  return box;
}

/// The farthest that a corner goes along an axis between two steps around a segment.
double greatest_way(const MovingMeshView& mesh, uint32_t primitive, uint32_t segment) {
  const uint32_t last = std::min(segment + 2, mesh.time.segment_count);
  uint32_t step = segment == 0 ? 0 : segment - 1;
  Vec3f before[3], after[3];
  corners_at(mesh, primitive, step, before);
  double farthest = 0.0;
  while (step++ != last) {
    corners_at(mesh, primitive, step, after);
    for (int k = 0; k < 3; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        farthest = std::max(farthest, std::fabs(double{after[k][axis]} - before[k][axis]));
      }
      before[k] = after[k];
    }
  }
  return farthest;
}

/// During a part of an own segment of the mesh, with room for the rounding of its ends: there the
/// mesh may already be, or still, in the own segment beside.
LinearBounds divided_bounds(const MovingMeshView& mesh, uint32_t primitive, uint32_t segment,
                            uint32_t division) {
  const double margin =
      place_rounding(mesh.time) * greatest_way(mesh, primitive, segment / division);
  const double place = segment;
  return {box_at(mesh, primitive, place / division, margin),
          box_at(mesh, primitive, (place + 1.0) / division, margin)};
}

/// Where the triangle is at any time of a segment of other steps.
Bounds swept_box(const MovingMeshView& mesh, uint32_t primitive, const TimeSteps& steps,
                 uint32_t segment) {
  Bounds box = Bounds::empty();
  PlaceRange range;
  if (!places_during(mesh.time, steps, segment, range)) return box;
  box.extend(box_at(mesh, primitive, range.first, 0.0));
  box.extend(box_at(mesh, primitive, range.last, 0.0));
  for (double key = std::ceil(range.first); key <= range.last; key += 1.0) {
    box.extend(box_at(mesh, primitive, static_cast<uint32_t>(key)));
  }
  return box;
}

}  // namespace

void pad(Bounds& box, const Bounds& extent) {
  for (int axis = 0; axis < 3; ++axis) {
    const double greatest =
        std::max(std::fabs(double{extent.lower[axis]}), std::fabs(double{extent.upper[axis]}));
    const double width = double{extent.upper[axis]} - extent.lower[axis];
    const double padding = kMotionRounding * (greatest + width) + kLeastRounding;
    box.lower[axis] = round_down(box.lower[axis] - padding);
    box.upper[axis] = round_up(box.upper[axis] + padding);
  }
}

uint32_t division_of(const TimeSteps& own, const TimeSteps& steps) {
  const bool divides = own.begin == steps.begin && own.end == steps.end &&
                       steps.segment_count % own.segment_count == 0;
  return divides ? steps.segment_count / own.segment_count : 0;
}

bool places_during(const TimeSteps& own, const TimeSteps& steps, uint32_t segment,
                   PlaceRange& range) {
  const double count = own.segment_count;
  const auto place_of = [&](double time) {
    return (time - own.begin) / (double{own.end} - own.begin) * count;
  };
  range.first = place_of(time_of(steps, segment - kTimeRounding));
  range.last = place_of(time_of(steps, segment + 1.0 + kTimeRounding));
  if (range.last < 0.0 || range.first > count) return false;
  range.first = std::max(range.first, 0.0);
  range.last = std::min(range.last, count);
  return true;
}

TriangleMeshView first_step_of(const MovingMeshView& mesh) {
  TriangleMeshView view{};
  view.vertices = mesh.vertices;
  view.vertex_stride = mesh.vertex_stride;
  view.vertex_count = mesh.vertex_count;
  view.indices = mesh.indices;
  view.index_stride = mesh.index_stride;
  view.triangle_count = mesh.triangle_count;
  view.first_id = mesh.first_id;
  view.geometry_id = mesh.geometry_id;
  view.mask = mesh.mask;
  return view;
}

void corners_at(const MovingMeshView& mesh, uint32_t primitive, uint32_t step, Vec3f corner[3]) {
  uint32_t index[3] = {3 * primitive, 3 * primitive + 1, 3 * primitive + 2};
  if (mesh.indices) {
    std::memcpy(index, mesh.indices + primitive * mesh.index_stride, sizeof index);
  }
  for (int k = 0; k < 3; ++k) {
    std::memcpy(&corner[k], mesh.vertices + step * mesh.step_stride + index[k] * mesh.vertex_stride,
                sizeof(Vec3f));
  }
}

Bounds box_at(const MovingMeshView& mesh, uint32_t primitive, uint32_t step) {
  Vec3f corner[3];
  corners_at(mesh, primitive, step, corner);
  Bounds box = Bounds::empty();
  for (const Vec3f& vertex : corner) box.extend(vertex);
  return box;
}

void corners_at(const MovingMeshView& mesh, uint32_t primitive, const TimePlace& place,
                Vec3f corner[3]) {
  Vec3f a[3], b[3];
  corners_at(mesh, primitive, place.segment, a);
  corners_at(mesh, primitive, place.segment + 1, b);
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      corner[k][axis] = (1.0f - place.fraction) * a[k][axis] + place.fraction * b[k][axis];
    }
  }
}

LinearBounds linear_bounds_of(const MovingMeshView& mesh, uint32_t primitive,
                              const TimeSteps& steps, uint32_t segment, const Bounds& extent) {
  LinearBounds bounds;
  const uint32_t division = division_of(mesh.time, steps);
  if (division == 1) {
    bounds = {box_at(mesh, primitive, segment), box_at(mesh, primitive, segment + 1)};
  } else if (division != 0) {
    bounds = divided_bounds(mesh, primitive, segment, division);
  } else {
    bounds.start = bounds.end = swept_box(mesh, primitive, steps, segment);
    if (bounds.start.is_empty()) return bounds;
  }
  pad(bounds.start, extent);
  pad(bounds.end, extent);
  return bounds;
}

}  // namespace kiwami
