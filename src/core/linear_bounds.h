// SPDX-License-Identifier: Apache-2.0
// Boxes that move linearly over a segment of time, around what moves.
#pragma once

#include "bvh/triangle_source.h"
#include "math/bounds.h"
#include "wide/motion_part.h"

namespace kiwami {

/// A box at the start and at the end of a segment; between them it is interpolated.
struct LinearBounds {
  Bounds start = Bounds::empty(), end = Bounds::empty();

  void extend(const LinearBounds& other) {
    start.extend(other.start);
    end.extend(other.end);
  }
};

/// Widens a box by the rounding of vertices and boxes at a time, in a scene that reaches as far as
/// extent.
void pad(Bounds& box, const Bounds& extent);

/// Into how many segments each of own ones is divided by steps; 0: they are others.
uint32_t division_of(const TimeSteps& own, const TimeSteps& steps);

/// How far apart the places of one time among own steps and among those that divide them may be, as
/// a part of an own segment: the quotient is the same, and each of two products of at most
/// segment_count is rounded once.
inline double place_rounding(const TimeSteps& own) { return own.segment_count * 0x1p-22; }

/// Places among some steps, 0 to segment_count.
struct PlaceRange {
  double first, last;
};

/// Where a segment of other steps lies among own ones, with room for the rounding of both; false:
/// nowhere.
bool places_during(const TimeSteps& own, const TimeSteps& steps, uint32_t segment,
                   PlaceRange& range);

/// A moving mesh as that of its first step.
TriangleMeshView first_step_of(const MovingMeshView& mesh);

/// The corners of a triangle at a step.
void corners_at(const MovingMeshView& mesh, uint32_t primitive, uint32_t step, Vec3f corner[3]);

/// The box of a triangle at a step.
Bounds box_at(const MovingMeshView& mesh, uint32_t primitive, uint32_t step);

/// The corners of a triangle at a place in its mesh's time, as the kernels compute them.
void corners_at(const MovingMeshView& mesh, uint32_t primitive, const TimePlace& place,
                Vec3f corner[3]);

/// Where a triangle is during a segment of steps that need not be its mesh's own. Empty where it
/// does not exist then. The boxes have room for all rounding of vertices and boxes at a time, in a
/// scene that reaches as far as extent.
LinearBounds linear_bounds_of(const MovingMeshView& mesh, uint32_t primitive,
                              const TimeSteps& steps, uint32_t segment, const Bounds& extent);

}  // namespace kiwami
