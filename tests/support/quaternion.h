// SPDX-License-Identifier: Apache-2.0
// What the documentation says of transforms with quaternions, in double precision.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

#include "kiwami/moving_instances.h"

namespace kiwami_tests {

using Quaternion = std::array<double, 4>;

/// Between two quaternions of any length along the shorter arc, by the formula of K. Shoemake,
/// "Animating Rotation with Quaternion Curves", SIGGRAPH 1985.
inline Quaternion slerp(Quaternion a, Quaternion b, double f) {
  const auto normalise = [](Quaternion& q) {
    const double length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    for (double& entry : q) entry /= length;
  };
  normalise(a);
  normalise(b);
  double dot = 0.0;
  for (size_t i = 0; i < 4; ++i) dot += a[i] * b[i];
  if (dot < 0.0) {
    for (double& entry : b) entry = -entry;
  }
  const double angle = std::acos(std::fmin(std::fabs(dot), 1.0));
  if (angle < 1e-9) return a;
  Quaternion made;
  for (size_t i = 0; i < 4; ++i) {
    made[i] = (std::sin((1 - f) * angle) * a[i] + std::sin(f * angle) * b[i]) / std::sin(angle);
  }
  return made;
}

/// v + 2 q x (q x v + r v): turned by a unit quaternion, without its matrix.
inline std::array<double, 3> turned(const Quaternion& q, const std::array<double, 3>& v) {
  const auto cross = [](const std::array<double, 3>& a, const std::array<double, 3>& b) {
    return std::array<double, 3>{a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                                 a[0] * b[1] - a[1] * b[0]};
  };
  const std::array<double, 3> axis = {q[1], q[2], q[3]};
  std::array<double, 3> inner = cross(axis, v);
  for (size_t i = 0; i < 3; ++i) inner[i] += q[0] * v[i];
  const std::array<double, 3> twice = cross(axis, inner);
  return {v[0] + 2 * twice[0], v[1] + 2 * twice[1], v[2] + 2 * twice[2]};
}

/// The matrix, three rows of four, at the part f of the way between two steps.
inline std::array<double, 12> matrix_between(const kiwami_quaternion_transform& start,
                                             const kiwami_quaternion_transform& end, double f) {
  const float *a = &start.scale_x, *b = &end.scale_x;
  double s[16];
  for (int k = 0; k < 16; ++k) s[k] = (1.0 - f) * double{a[k]} + f * double{b[k]};
  const Quaternion q = slerp({a[9], a[10], a[11], a[12]}, {b[9], b[10], b[11], b[12]}, f);
  const std::array<double, 3> columns[4] = {turned(q, {s[0], 0, 0}), turned(q, {s[3], s[1], 0}),
                                            turned(q, {s[4], s[5], s[2]}),
                                            turned(q, {s[6], s[7], s[8]})};
  std::array<double, 12> matrix;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t k = 0; k < 4; ++k) {
      matrix[4 * row + k] = columns[k][row] + (k == 3 ? s[13 + row] : 0.0);
    }
  }
  return matrix;
}

}  // namespace kiwami_tests
