// SPDX-License-Identifier: Apache-2.0
// Affine maps of space, in double precision: the same for kernels and baseline code.
#pragma once

#include "math/vec3.h"

// Always inlined: objects of several instruction sets must not share one copy.
#define KIWAMI_AFFINE __attribute__((always_inline)) inline

namespace kiwami {

/// x goes to column[0] x.x + column[1] x.y + column[2] x.z + column[3].
struct Affine {
  double column[4][3];
};

/// The greatest sum of absolute values in a row of the linear part: by so much the greatest
/// absolute coordinate of a difference grows at most.
KIWAMI_AFFINE double row_sum_norm(const Affine& map) {
  double greatest = 0.0;
  for (int row = 0; row < 3; ++row) {
    double sum = 0.0;
    for (int k = 0; k < 3; ++k) sum += __builtin_fabs(map.column[k][row]);
    greatest = greatest < sum ? sum : greatest;
  }
  return greatest;
}

/// Of the linear part.
KIWAMI_AFFINE double cofactor_of(const Affine& map, int i, int j) {
  const auto& c = map.column;
  const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
  return c[i1][j1] * c[i2][j2] - c[i1][j2] * c[i2][j1];
}

/// The inverse, by the adjugate. Of a singular map its entries are not finite.
KIWAMI_AFFINE Affine inverse_of(const Affine& map) {
  const auto& c = map.column;
  const double determinant = (c[0][0] * cofactor_of(map, 0, 0) + c[0][1] * cofactor_of(map, 0, 1)) +
                             c[0][2] * cofactor_of(map, 0, 2);
  Affine inverse;
  for (int k = 0; k < 3; ++k) {
    for (int row = 0; row < 3; ++row) {
      inverse.column[k][row] = cofactor_of(map, row, k) / determinant;
    }
  }
  for (int row = 0; row < 3; ++row) {
    inverse.column[3][row] =
        -((inverse.column[0][row] * c[3][0] + inverse.column[1][row] * c[3][1]) +
          inverse.column[2][row] * c[3][2]);
  }
  return inverse;
}

KIWAMI_AFFINE bool is_finite(const Affine& map) {
  bool is = true;
  for (int k = 0; k < 4; ++k) {
    for (int row = 0; row < 3; ++row) is = is && __builtin_isfinite(map.column[k][row]) != 0;
  }
  return is;
}

}  // namespace kiwami

#undef KIWAMI_AFFINE
