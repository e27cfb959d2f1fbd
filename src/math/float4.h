// SPDX-License-Identifier: Apache-2.0
// Four floats that are computed with at once, by the vector extension of GCC and Clang: for the
// parts of a build that have no kernel of their own. The same bits on every machine.
#pragma once

#include <cstdint>
#include <cstring>

#include "math/bounds.h"

namespace kiwami {

using Float4 = float __attribute__((vector_size(16)));
using Int4 = int32_t __attribute__((vector_size(16)));

/// Three floats at any address, and 0.
inline Float4 load3(const void* address) {
  using Long2 = int64_t __attribute__((vector_size(16)));
  int64_t first_two;
  uint32_t third;
  std::memcpy(&first_two, address, sizeof first_two);
  std::memcpy(&third, static_cast<const char*>(address) + sizeof first_two, sizeof third);
  const Long2 bits = {first_two, static_cast<int64_t>(third)};
  Float4 loaded;
  std::memcpy(&loaded, &bits, sizeof loaded);
  return loaded;
}

/// As min_keep and max_keep of floats.
inline Float4 min_keep(Float4 accumulated, Float4 other) {
  return other < accumulated ? other : accumulated;
}
inline Float4 max_keep(Float4 accumulated, Float4 other) {
  return other > accumulated ? other : accumulated;
}

/// Whether a comparison is true everywhere.
inline bool is_true_everywhere(Int4 comparison) {
  int64_t halves[2];
  std::memcpy(halves, &comparison, sizeof halves);
  return (halves[0] & halves[1]) == -1;
}

/// a - b rounded towards -infinity (+infinity), for finite a and b below 2^126: exactly what
/// subtract_down and subtract_up of rounding.h give.
inline Float4 subtract_down(Float4 a, Float4 b) {
  const Float4 difference = a - b;
  // What the difference could not hold (Knuth's two-sum).
  const Float4 back = difference - a;
  const Float4 error = (a - (difference - back)) - (b + back);
  Int4 bits;
  std::memcpy(&bits, &difference, sizeof bits);
  // One unit in the last place down; a difference of 0 is exact.
  const Int4 lower = bits + (bits < 0 ? Int4{1, 1, 1, 1} : Int4{-1, -1, -1, -1});
  const Int4 chosen = error < Float4{0.0f, 0.0f, 0.0f, 0.0f} ? lower : bits;
  Float4 rounded;
  std::memcpy(&rounded, &chosen, sizeof rounded);
  return rounded;
}
inline Float4 subtract_up(Float4 a, Float4 b) { return -subtract_down(b, a); }

/// A box whose corners have a fourth component, of no meaning.
struct Bounds4 {
  Float4 lower, upper;

  static Bounds4 empty() {
    const float infinity = Bounds::empty().lower.x;
    const Float4 lower = {infinity, infinity, infinity, infinity};
    return {lower, -lower};
  }

  void extend(const Bounds4& other) {
    lower = min_keep(lower, other.lower);
    upper = max_keep(upper, other.upper);
  }

  Bounds bounds() const { return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}}; }
};

}  // namespace kiwami
