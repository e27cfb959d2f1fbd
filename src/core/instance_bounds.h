// SPDX-License-Identifier: Apache-2.0
// Where what an instance shows can be hit, and how far from it the points of hits lie.
#pragma once

#include "math/affine.h"
#include "math/bounds.h"
#include "wide/instance_part.h"

namespace kiwami {

/// Of a number that is rounded to a float, in parts of it.
constexpr double kRoundingUnit = 0x1p-24;

/// How far from what it hit the point of a hit may lie, along any axis: 2^-24 (per_origin o +
/// fixed), o being the greatest absolute coordinate of the ray's origin.
struct HitError {
  double per_origin = 0.0;
  double fixed = 0.0;

  void extend(const HitError& other);
  /// For rays from no farther than an origin.
  double margin(double origin) const { return kRoundingUnit * (per_origin * origin + fixed); }
  /// Of triangles in a box. See kMargin in kernels/ray-inl.h: 9 (M_a + S_a M_kz), where M is at
  /// most the origin's coordinate and twice the box's greatest, and S at most 1.
  static HitError of_triangles(const Bounds& bounds);
  /// Of what is hit through the floats of a record, which shows what has the error inner and lies
  /// in bounds, in the outer space.
  static HitError through(const float (&inverse)[4][3], const HitError& inner,
                          const Bounds& bounds);
};

/// How far an instance that moves goes, at all times.
struct MotionLimits {
  double condition;     ///< of the maps that rays meet: at most kMaxCondition
  double forward_norm;  ///< of the matrices, by row sums
  double shift;         ///< the greatest absolute coordinate of a matrix's last column
  bool is_regular;      ///< whether invert_for_rays takes the matrices of all times

  /// Of steps as kernels have them, one after the other.
  static MotionLimits of(const float* steps, uint32_t segment_count, TransformFormat format);
  /// As HitError::through, of all times.
  HitError error_through(const HitError& inner, const Bounds& bounds) const;
  /// The greatest absolute coordinate of a point of inner, the box of a scene, outside.
  double reach(const Bounds& inner) const;
  /// How far from where the motion of its matrix has a point of inner it is
  /// shown: the rounding of the matrix, and what the rounded inverse stands for.
  double rounding(const Bounds& inner) const;
};

/// How far the points of a box go from the straight way between two steps.
double bow_of(const float* steps, TransformFormat format, const Bounds& inner);

/// See ScenePart.
float far_origin_margin_of(const HitError& error);

double greatest_coordinate(const Bounds& bounds);

/// The box of a box's image, wider by a margin and rounded outwards.
Bounds image_of(const Affine& map, const Bounds& box, double margin);

}  // namespace kiwami
