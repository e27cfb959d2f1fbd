// SPDX-License-Identifier: Apache-2.0
// Exponentially distributed random numbers without a library's logarithm, whose last bits differ
// from machine to machine.
#pragma once

#include <cstdint>
#include <cstring>

namespace kiwami {

/// 2 artanh(s) for |s| <= 0.172: the series, whose first term that is left out is below 2^-55 of
/// the sum.
inline double twice_artanh(double s) {
  const double z = s * s, z2 = z * z, z4 = z2 * z2;
  // In an order that lets a processor compute much of it at once.
  const double first = (1.0 + 1.0 / 3.0 * z) + (1.0 / 5.0 + 1.0 / 7.0 * z) * z2;
  const double second = (1.0 / 9.0 + 1.0 / 11.0 * z) + (1.0 / 13.0 + 1.0 / 15.0 * z) * z2;
  const double third = 1.0 / 17.0 + 1.0 / 19.0 * z;
  return 2.0 * s * (first + (second + third * z4) * z4);
}

/// -ln(1 - u) for 0 <= u < 1, to all but the last bits also where u is tiny.
inline double exponential_of(double u) {
  constexpr double kLn2 = 0.693147180559945309417;
  constexpr uint64_t kExponentOne = uint64_t{1} << 52;
  // Up to here ln(1 - u) = -2 artanh(u / (2 - u)) needs no 1 - u, which would round.
  if (u < 0.25) return twice_artanh(u / (2.0 - u));
  const double rest = 1.0 - u;
  uint64_t bits;
  std::memcpy(&bits, &rest, sizeof bits);
  // rest = mantissa * 2^-halvings, the mantissa between sqrt(1/2) and sqrt(2) or so.
  constexpr uint64_t kRootOfHalf = 0x3FE6A09E667F3BCDu;
  const uint64_t halvings = (kRootOfHalf + kExponentOne - 1 - bits) >> 52;
  bits += halvings << 52;
  double mantissa;
  std::memcpy(&mantissa, &bits, sizeof mantissa);
  return static_cast<double>(halvings) * kLn2 + twice_artanh((1.0 - mantissa) / (1.0 + mantissa));
}

}  // namespace kiwami
