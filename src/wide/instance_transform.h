// SPDX-License-Identifier: Apache-2.0
// The transforms of instances, at rest and at a time, and their inverses, as kernels apply them.
// Kernels and baseline code go through the same operations in the same order, so that an instance
// that moves is, at each time, just one that does not. Rotations are interpolated by quaternions, at
// constant speed along the shorter arc (K. Shoemake, "Animating Rotation with Quaternion Curves",
// SIGGRAPH 1985). It departs from that in that the sines are polynomials, which every machine rounds
// in the same way, and that the quaternion is not normalised: what counts is its direction.
#pragma once

#include "math/affine.h"
#include "wide/time_steps.h"

// Always inlined: objects of several instruction sets must not share one copy.
#define KIWAMI_TRANSFORM __attribute__((always_inline)) inline

namespace kiwami {

/// Values of kiwami_transform_format.
enum class TransformFormat : uint32_t { kMatrix, kQuaternion };

/// Floats of a step.
constexpr uint32_t step_size_of(TransformFormat format) {
  return format == TransformFormat::kMatrix ? 12 : 17;
}

/// Beyond these an inverse in floats says little of the matrix, and margins cover scenes.
constexpr double kMaxCondition = 0x1p20;
constexpr double kMaxScale = 0x1p60;

/// Where the entries of a step with a quaternion stand: those of a kiwami_quaternion_transform, the
/// quaternion being of length 1, then the square of the angle between it and that of the next step.
enum QuaternionField : uint32_t {
  kScale = 0,
  kSkewXy = 3,
  kSkewXz = 4,
  kSkewYz = 5,
  kShift = 6,
  kQuaternion = 9,
  kTranslation = 13,
  kSquaredAngle = 16
};

/// The map of a matrix of three rows.
KIWAMI_TRANSFORM Affine map_of(const float (&rows)[12]) {
  Affine map;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) map.column[k][row] = double{rows[4 * row + k]};
  }
  return map;
}

/// Of a quaternion of any length but 0.
KIWAMI_TRANSFORM void rotation_of(const double (&quaternion)[4], double (&rotation)[3][3]) {
  const double r = quaternion[0], i = quaternion[1], j = quaternion[2], k = quaternion[3];
  const double s = 2.0 / (((r * r + i * i) + j * j) + k * k);
  rotation[0][0] = 1.0 - s * (j * j + k * k);
  rotation[0][1] = s * (i * j - k * r);
  rotation[0][2] = s * (i * k + j * r);
  rotation[1][0] = s * (i * j + k * r);
  rotation[1][1] = 1.0 - s * (i * i + k * k);
  rotation[1][2] = s * (j * k - i * r);
  rotation[2][0] = s * (i * k - j * r);
  rotation[2][1] = s * (j * k + i * r);
  rotation[2][2] = 1.0 - s * (i * i + j * j);
}

/// What goes before the rotation: the upper triangle of scale and skew, and the shift.
KIWAMI_TRANSFORM Affine stretch_of(const double (&step)[16]) {
  return {{{step[kScale], 0.0, 0.0},
           {step[kSkewXy], step[kScale + 1], 0.0},
           {step[kSkewXz], step[kSkewYz], step[kScale + 2]},
           {step[kShift], step[kShift + 1], step[kShift + 2]}}};
}

/// The matrix of what a kiwami_quaternion_transform holds.
KIWAMI_TRANSFORM void matrix_of(const double (&step)[16], float (&rows)[12]) {
  const double quaternion[4] = {step[kQuaternion], step[kQuaternion + 1], step[kQuaternion + 2],
                                step[kQuaternion + 3]};
  double rotation[3][3];
  rotation_of(quaternion, rotation);
  const Affine stretch = stretch_of(step);
  for (int row = 0; row < 3; ++row) {
    const double* r = rotation[row];
    for (int k = 0; k < 4; ++k) {
      const auto& column = stretch.column[k];
      const double sum = (r[0] * column[0] + r[1] * column[1]) + r[2] * column[2];
      rows[4 * row + k] = static_cast<float>(k < 3 ? sum : sum + step[kTranslation + row]);
    }
  }
}

/// The matrix of a step.
KIWAMI_TRANSFORM void matrix_of_step(const float* step, TransformFormat format, float (&rows)[12]) {
  if (format == TransformFormat::kMatrix) {
    for (int i = 0; i < 12; ++i) rows[i] = step[i];
    return;
  }
  double wide[16];
  for (int i = 0; i < 16; ++i) wide[i] = step[i];
  matrix_of(wide, rows);
}

/// sin(x) / x of x * x = y from 0 to (pi / 2)^2: its series, cut where a term is below 2^-44.
KIWAMI_TRANSFORM double sine_ratio(double y) {
  double sum = 1.0;
  for (int n = 16; n >= 2; n -= 2) sum = 1.0 - y * (1.0 / (n * (n + 1))) * sum;
  return sum;
}

/// The matrix at a place between two steps, which lie one after the other.
KIWAMI_TRANSFORM void matrix_between(const float* steps, TransformFormat format, float fraction,
                                     float (&rows)[12]) {
  if (format == TransformFormat::kMatrix) {
    const float of_start = 1.0f - fraction;
    for (int i = 0; i < 12; ++i) rows[i] = of_start * steps[i] + fraction * steps[12 + i];
    return;
  }
  const float* const next = steps + step_size_of(TransformFormat::kQuaternion);
  const double end = fraction, start = 1.0 - end;
  const double angle = steps[kSquaredAngle];
  const double arc_start = start * sine_ratio(start * start * angle);
  const double arc_end = end * sine_ratio(end * end * angle);
  double step[16];
  for (uint32_t i = 0; i < 16; ++i) {
    const bool is_on_arc = kQuaternion <= i && i < kTranslation;
    step[i] = (is_on_arc ? arc_start : start) * double{steps[i]} +
              (is_on_arc ? arc_end : end) * double{next[i]};
  }
  matrix_of(step, rows);
}

KIWAMI_TRANSFORM bool is_in_scale(double norm) {
  return 1.0 / kMaxScale <= norm && norm <= kMaxScale;
}

/// What the floats of an inverse stand for.
KIWAMI_TRANSFORM Affine map_of(const float (&inverse)[4][3]) {
  Affine map;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) map.column[k][row] = double{inverse[k][row]};
  }
  return map;
}

KIWAMI_TRANSFORM void round_to_floats(const Affine& map, float (&rounded)[4][3]) {
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) rounded[k][row] = static_cast<float>(map.column[k][row]);
  }
}

/// The same as invert_for_rays of a matrix that is known to be neither singular nor out of scale.
KIWAMI_TRANSFORM void invert_regular(const float (&rows)[12], float (&inverse)[4][3]) {
  round_to_floats(inverse_of(map_of(rows)), inverse);
}

/// The inverse of a matrix of three rows as kernels apply it: rounded to floats. False for a matrix
/// that is not finite or singular.
KIWAMI_TRANSFORM bool invert_for_rays(const float (&rows)[12], float (&inverse)[4][3]) {
  const Affine map = map_of(rows);
  const double norm = row_sum_norm(map);
  if (!is_finite(map) || !is_in_scale(norm)) return false;
  const Affine exact = inverse_of(map);
  const double exact_norm = row_sum_norm(exact);
  if (!is_finite(exact) || !is_in_scale(exact_norm)) return false;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) {
      if (__builtin_fabs(exact.column[k][row]) > double{__FLT_MAX__}) return false;
    }
  }
  round_to_floats(exact, inverse);
  // The floats' own inverse is within a fourth of the matrix where this is far from the limit.
  if (norm * exact_norm <= kMaxCondition / 4) return true;
  const Affine rounded = map_of(inverse), forward = inverse_of(rounded);
  return is_finite(forward) && row_sum_norm(rounded) * row_sum_norm(forward) <= kMaxCondition;
}

}  // namespace kiwami

#undef KIWAMI_TRANSFORM
