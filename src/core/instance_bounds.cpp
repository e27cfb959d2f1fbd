// SPDX-License-Identifier: Apache-2.0
// Why every hit is found
//
// A ray o + t d meets instances by their boxes in the outer space, and what they show by the ray
// o' + t d' in the space of their scene. Let B x + b be the map into that space, as the floats of
// the record have it, F its inverse, and |.| the greatest absolute coordinate or the row sum norm.
// The record's floats are what counts: boxes are made of F, whatever the rounding of the inverse.
//
// A hit at t in the instanced scene is at a point P' of what was hit plus an error e', that is o' +
// t d' = P' + e'. With the roundings r and s of o' = B o + b + r, |r| <= 4 u (|B| |o| + |b|), and
// d' = B d + s, |s| <= 3 u |B| |d|, the point on the outer ray is
//   o + t d = F (P' - b) + F (e' - r - t s),
// where F (P' - b) lies in the instance's box. So along each axis it is outside by at most
//   |F| (|e'| + 4 u (|B| |o| + |b|) + 3 u |B| t |d|).
// By induction over the levels, |e'| <= u (p' |o'| + f') with the HitError of the instanced scene,
// |o'| <= |B| |o| + |b|, and t |d| is at most |o| + Q plus the error itself, Q being the greatest
// coordinate of the box. With the condition number k = |F| |B|, this is a HitError again:
//   per_origin = k (p' + 7),   fixed = |F| ((p' + 4) |b| + f' + 3 |B| Q),
// times 1.25: the error that stands on the right is at most 3 u k < 3/16 of the whole (k <= 2^20),
// and what remains is for products of errors and for F, whose double entries are off by far less.
//
// The tree's boxes are those of the instances, wider by that error for origins up to far_origin;
// for rays that start farther away the kernels widen the slabs by per_origin times what is beyond.
//
// Instances that move
//
// At a time, an instance is one that does not move, with the matrix M of that time, m being its last
// column, and B the floats of its inverse as above. Two things are different here: boxes come from
// the matrices of the steps, so they have to allow for what M, its inverse and the rounding of both
// do at other times; and the condition number k = |F| |B| counts that is the greatest of all times.
//
// F differs from M by what the rounding E of B does, |E| <= u |B|: F - M = -F E M. So a point P' is
// shown within u k |M| |P'| of M P', and the rounded b adds at most 2 u k |m|, since F M^-1 m - m =
// -F E m. The floats of M are off by 3 u of what is interpolated (matrices), or by u of their
// entries and a little of the angle (quaternions): 2^-20 covers both.
//
// Matrices are interpolated linearly, so each point goes straight, and evenly, from its place at one
// step to that at the next: the boxes of both, interpolated, hold it. With quaternions it is at
// T + R y, where T and y = S P' go straight and R turns evenly by the angle phi about one axis. The
// second derivative of R y by f is R'' y + 2 R' y', of length at most phi^2 |y| + 2 phi |y'|, so that
// R y bows out of its chord by at most an eighth of that.
//
// k comes from bisection. Around the middle c of an interval, with D the difference of the steps'
// matrices, M(f) = (I + (f - c) D M(c)^-1) M(c) = M(c) (I + (f - c) M(c)^-1 D). So where g = |f - c|
// times the lesser of |D M(c)^-1| and |M(c)^-1 D| is at most 1/4, |M(f)^-1| <= |M(c)^-1| / (1 - g);
// else the interval is divided. Of an instance that gets singular on its way this finds no end, nor
// does it have to: rays do not meet it while k is above 2^20.
#include "core/instance_bounds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/instances.h"
#include "kiwami/geometry.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

constexpr double kSafety = 1.25;
/// Products of the transform may be denormal.
constexpr double kLeastError = 0x1p-100;
/// Boxes end here: nothing beyond KIWAMI_MAX_COORDINATE is promised to be hit.
constexpr double kMaxBound = 2.0 * double{KIWAMI_MAX_COORDINATE};

/// Of the rounded maps by those of the exact matrices: a matrix that is off by 2^-22 has an inverse
/// that is off by a third where k is 2^20, and the inverse is rounded itself.
constexpr double kConditionSafety = 1.5;
/// What forward maps may be greater than their matrices by, at 2^20.
constexpr double kForwardSafety = 1.07;
/// Intervals that bisection looks at between two steps.
constexpr int kMaxIntervals = 512;
/// Off the exact motion of a point, in parts of its coordinates.
constexpr double kMotionError = 0x1p-20;
/// For the rounding of what is computed here.
constexpr double kSlightlyMore = 1.0 + 0x1p-18;
/// Of a rotation, at most.
constexpr double kRotationNorm = 1.7320509;

Affine difference_of(const Affine& a, const Affine& b) {
  Affine difference;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) {
      difference.column[k][row] = b.column[k][row] - a.column[k][row];
    }
  }
  return difference;
}

/// a + f d.
Affine moved(const Affine& a, const Affine& d, double f) {
  Affine sum;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) {
      sum.column[k][row] = a.column[k][row] + f * d.column[k][row];
    }
  }
  return sum;
}

/// The linear part of a after b.
Affine product_of(const Affine& a, const Affine& b) {
  Affine product{};
  for (int k = 0; k < 3; ++k) {
    for (int row = 0; row < 3; ++row) {
      for (int i = 0; i < 3; ++i) product.column[k][row] += a.column[i][row] * b.column[k][i];
    }
  }
  return product;
}

/// Of what lies between two maps: the greatest condition number, and the greatest norm of an
/// inverse. kMaxCondition: it is as great, or not known.
struct InverseBound {
  double condition, norm;
};

InverseBound bound_inverses(const Affine& start, const Affine& end) {
  constexpr InverseBound unknown{kMaxCondition, std::numeric_limits<double>::infinity()};
  struct Interval {
    double begin, end;
  };
  constexpr size_t kMaxDepth = 32;
  Interval stack[kMaxDepth + 1] = {{0.0, 1.0}};
  size_t depth = 1;
  const Affine difference = difference_of(start, end);
  InverseBound greatest{1.0, 0.0};
  for (int i = 0; depth != 0; ++i) {
    if (i == kMaxIntervals) return unknown;
    const Interval interval = stack[--depth];
    const double middle = 0.5 * (interval.begin + interval.end);
    const Affine map = moved(start, difference, middle), inverse = inverse_of(map);
    const double half = 0.5 * (interval.end - interval.begin);
    const double change = half * std::min(row_sum_norm(product_of(difference, inverse)),
                                          row_sum_norm(product_of(inverse, difference)));
    const double norm = row_sum_norm(map) + half * row_sum_norm(difference);
    const double inverse_norm = row_sum_norm(inverse);
    // Comparisons with NaN are false, and norms of it may be 0.
    if (!is_finite(inverse) || !(norm * inverse_norm < kMaxCondition)) return unknown;
    if (change <= 0.25) {
      greatest.norm = std::max(greatest.norm, inverse_norm / (1.0 - change));
      greatest.condition = std::max(greatest.condition, norm * inverse_norm / (1.0 - change));
      continue;
    }
    if (depth + 2 > kMaxDepth) return unknown;
    stack[depth++] = {middle, interval.end};
    stack[depth++] = {interval.begin, middle};
  }
  greatest.condition = std::min(greatest.condition, kMaxCondition);
  return greatest;
}

/// The part of a step that is interpolated linearly: all of it, or what goes before the rotation.
Affine linear_part_of(const float* step, TransformFormat format) {
  if (format == TransformFormat::kMatrix) {
    float rows[12];
    std::copy_n(step, 12, rows);
    return map_of(rows);
  }
  double wide[16];
  std::copy_n(step, 16, wide);
  return stretch_of(wide);
}

double greatest_of(const double (&vector)[3]) {
  return std::max({std::fabs(vector[0]), std::fabs(vector[1]), std::fabs(vector[2])});
}

/// The length of the longest vector from the origin to a point of the image of a box.
double reach_of(const Affine& map, const Bounds& box) {
  const Bounds image = image_of(map, box, 0.0);
  double sum = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double reach =
        std::max(std::fabs(double{image.lower[axis]}), std::fabs(double{image.upper[axis]}));
    sum += reach * reach;
  }
  return std::sqrt(sum);
}

}  // namespace

void HitError::extend(const HitError& other) {
  per_origin = std::max(per_origin, other.per_origin);
  fixed = std::max(fixed, other.fixed);
}

HitError HitError::of_triangles(const Bounds& bounds) {
  if (bounds.is_empty()) return {};
  return {18.0, 18.0 * 2.001 * greatest_coordinate(bounds) + kLeastError / kRoundingUnit};
}

HitError HitError::through(const float (&inverse)[4][3], const HitError& inner,
                           const Bounds& bounds) {
  const InstanceTransform transform = transform_of(inverse);
  const double b = std::max({std::fabs(double{inverse[3][0]}), std::fabs(double{inverse[3][1]}),
                             std::fabs(double{inverse[3][2]})});
  HitError error;
  error.per_origin =
      kSafety * transform.forward_norm * transform.inverse_norm * (inner.per_origin + 7.0);
  error.fixed =
      kSafety * transform.forward_norm *
      ((inner.per_origin + 4.0) * b + inner.fixed +
       3.0 * transform.inverse_norm * greatest_coordinate(bounds) + kLeastError / kRoundingUnit);
  return error;
}

MotionLimits MotionLimits::of(const float* steps, uint32_t segment_count, TransformFormat format) {
  const uint32_t size = step_size_of(format);
  MotionLimits limits{1.0, 0.0, 0.0, false};
  double inverse_norm = 0.0;
  Affine before{};
  for (uint32_t step = 0; step <= segment_count; ++step) {
    const float* const at = steps + size_t{step} * size;
    const Affine map = linear_part_of(at, format);
    double norm = row_sum_norm(map), shift = greatest_of(map.column[3]);
    if (format == TransformFormat::kQuaternion) {
      norm *= kRotationNorm;
      const double translation[3] = {at[kTranslation], at[kTranslation + 1], at[kTranslation + 2]};
      shift = kRotationNorm * shift + greatest_of(translation);
    }
    limits.forward_norm = std::max(limits.forward_norm, norm * kSlightlyMore);
    limits.shift = std::max(limits.shift, shift * kSlightlyMore);
    if (step != 0) {
      const InverseBound bound = bound_inverses(before, map);
      limits.condition = std::max(limits.condition, bound.condition);
      inverse_norm = std::max(inverse_norm, bound.norm);
    }
    before = map;
  }
  // Of a rotation and its inverse.
  if (format == TransformFormat::kQuaternion) {
    limits.condition *= kRotationNorm * kRotationNorm;
    inverse_norm *= kRotationNorm;
  }
  limits.condition = std::min(kConditionSafety * limits.condition, kMaxCondition);
  // Far from all limits. The scales are bounded from below by each other: a norm is at least 1 over
  // that of the inverse.
  limits.is_regular = limits.condition <= kMaxCondition / 4 &&
                      limits.forward_norm <= kMaxScale / 4 && inverse_norm <= kMaxScale / 4 &&
                      limits.shift <= kMaxScale;
  return limits;
}

HitError MotionLimits::error_through(const HitError& inner, const Bounds& bounds) const {
  HitError error;
  error.per_origin = kSafety * condition * (inner.per_origin + 7.0);
  error.fixed =
      kSafety * (condition * ((inner.per_origin + 4.0) * kSlightlyMore * shift +
                              3.0 * greatest_coordinate(bounds)) +
                 kForwardSafety * forward_norm * (inner.fixed + kLeastError / kRoundingUnit));
  return error;
}

double MotionLimits::reach(const Bounds& inner) const {
  return forward_norm * greatest_coordinate(inner) + shift;
}

double MotionLimits::rounding(const Bounds& inner) const {
  return 1.1 * kRoundingUnit * condition * (reach(inner) + shift) + kMotionError * reach(inner) +
         kLeastError;
}

double bow_of(const float* steps, TransformFormat format, const Bounds& inner) {
  if (format == TransformFormat::kMatrix) return 0.0;
  const Affine start = linear_part_of(steps, format);
  const Affine end = linear_part_of(steps + step_size_of(format), format);
  const double phi = 2.0 * std::sqrt(double{steps[kSquaredAngle]}) * kSlightlyMore;
  const double reach = std::max(reach_of(start, inner), reach_of(end, inner));
  const double change = reach_of(difference_of(start, end), inner);
  return kSlightlyMore * phi * (phi * reach + 2.0 * change) / 8.0;
}

float far_origin_margin_of(const HitError& error) {
  const double margin = kRoundingUnit * 1.001 * error.per_origin;
  return static_cast<float>(std::min(margin, double{std::numeric_limits<float>::max()}));
}

double greatest_coordinate(const Bounds& bounds) {
  double greatest = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    greatest = std::max(
        {greatest, std::fabs(double{bounds.lower[axis]}), std::fabs(double{bounds.upper[axis]})});
  }
  return greatest;
}

/// The box of a box's image, wider by a margin and rounded outwards.
Bounds image_of(const Affine& map, const Bounds& box, double margin) {
  Bounds image;
  for (int row = 0; row < 3; ++row) {
    double lower = map.column[3][row], upper = lower;
    for (int k = 0; k < 3; ++k) {
      const double a = map.column[k][row] * double{box.lower[k]};
      const double b = map.column[k][row] * double{box.upper[k]};
      lower += std::min(a, b);
      upper += std::max(a, b);
    }
    image.lower[row] = round_down(std::clamp(lower - margin, -kMaxBound, kMaxBound));
    image.upper[row] = round_up(std::clamp(upper + margin, -kMaxBound, kMaxBound));
  }
  return image;
}

}  // namespace kiwami
