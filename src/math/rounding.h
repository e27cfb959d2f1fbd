// SPDX-License-Identifier: Apache-2.0
// Directed rounding without touching the rounding mode.
#pragma once

#include <bit>
#include <cstdint>

namespace kiwami {

/// The next float above (below) a finite value.
inline float next_up(float value) {
  const uint32_t bits = std::bit_cast<uint32_t>(value);
  if (value == 0.0f) return std::bit_cast<float>(uint32_t{1});
  return std::bit_cast<float>(value > 0.0f ? bits + 1 : bits - 1);
}
inline float next_down(float value) { return -next_up(-value); }

/// A double within the range of floats, rounded towards -infinity (+infinity).
inline float round_down(double value) {
  const float rounded = static_cast<float>(value);
  return static_cast<double>(rounded) > value ? next_down(rounded) : rounded;
}
inline float round_up(double value) { return -round_down(-value); }

/// a - b rounded towards -infinity (+infinity), for finite a and b.
inline float subtract_down(float a, float b) {
  const double wide_a = a, wide_b = b;
  const double difference = wide_a - wide_b;
  // What the double could not hold where the exponents lie far apart (Knuth's two-sum).
  const double back = difference - wide_a;
  const double error = (wide_a - (difference - back)) - (wide_b + back);
  const float rounded = static_cast<float>(difference);
  const double wide_rounded = rounded;
  const bool is_above = wide_rounded > difference || (wide_rounded == difference && error < 0.0);
  return is_above ? next_down(rounded) : rounded;
}
inline float subtract_up(float a, float b) { return -subtract_down(b, a); }

}  // namespace kiwami
