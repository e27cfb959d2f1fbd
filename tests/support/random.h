// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <cstdint>

namespace kiwami_tests {

/// Reproducible on every compiler, unlike the distributions of the standard library: PCG-XSH-RR
/// 64/32 (M. O'Neill, "PCG: A Family of Simple Fast Space-Efficient Statistically Good Algorithms
/// for Random Number Generation", Harvey Mudd College HMC-CS-2014-0905, 2014).
class Random {
 public:
  explicit Random(uint64_t seed, uint64_t stream = 0) : increment_(2 * stream + 1) {
    bits();
    state_ += seed;
    bits();
  }

  uint32_t bits() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005ull + increment_;
    const auto shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const auto turn = static_cast<uint32_t>(old >> 59);
    return (shifted >> turn) | (shifted << ((32 - turn) & 31));
  }

  /// A number below count, which must not be 0.
  uint32_t below(uint32_t count) {
    return static_cast<uint32_t>((static_cast<uint64_t>(bits()) * count) >> 32);
  }
  int between(int low, int high) {
    return low + static_cast<int>(below(static_cast<uint32_t>(high - low + 1)));
  }
  /// True once in `count` times.
  bool one_in(uint32_t count) { return below(count) == 0; }

  /// 0 <= result < 1, a multiple of 2^-24.
  float unit() { return static_cast<float>(bits() >> 8) * 0x1p-24f; }
  /// -1 <= result < 1.
  float symmetric() { return static_cast<float>(bits() >> 8) * 0x1p-23f - 1.0f; }
  float power_of_two(int lowest, int highest) { return std::ldexp(1.0f, between(lowest, highest)); }

 private:
  uint64_t state_ = 0;
  uint64_t increment_;
};

}  // namespace kiwami_tests
