// SPDX-License-Identifier: Apache-2.0
// Affine maps of space, in double precision.
#pragma once

#include <algorithm>
#include <cmath>

#include "math/vec3.h"

namespace kiwami {

/// x goes to column[0] x.x + column[1] x.y + column[2] x.z + column[3].
struct Affine {
  double column[4][3];
};

/// The greatest sum of absolute values in a row of the linear part: by so much the greatest
/// absolute coordinate of a difference grows at most.
inline double row_sum_norm(const Affine& map) {
  double greatest = 0.0;
  for (int row = 0; row < 3; ++row) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) sum += std::fabs(map.column[k][row]);
    greatest = std::max(greatest, sum);
  }
  return greatest;
}

/// The inverse, by the adjugate. Of a singular map its entries are not finite.
inline Affine inverse_of(const Affine& map) {
  const auto& c = map.column;
  const auto cofactor = [&](int i, int j) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
    return c[i1][j1] * c[i2][j2] - c[i1][j2] * c[i2][j1];
  };
  const double determinant =
      (c[0][0] * cofactor(0, 0) + c[0][1] * cofactor(0, 1)) + c[0][2] * cofactor(0, 2);
  Affine inverse;
  for (int k = 0; k < 3; ++k) {
    for (int row = 0; row < 3; ++row) inverse.column[k][row] = cofactor(row, k) / determinant;
  }
  for (int row = 0; row < 3; ++row) {
    inverse.column[3][row] =
        -((inverse.column[0][row] * c[3][0] + inverse.column[1][row] * c[3][1]) +
          inverse.column[2][row] * c[3][2]);
  }
  return inverse;
}

}  // namespace kiwami
