// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kiwami::tools {

/// Random numbers that are the same on every machine. PCG-XSH-RR 64/32: M. E. O'Neill, "PCG: A
/// Family of Simple Fast Space-Efficient Statistically Good Algorithms for Random Number
/// Generation", Harvey Mudd College HMC-CS-2014-0905, 2014. Different streams are independent.
class Random {
 public:
  explicit Random(uint64_t seed, uint64_t stream = 0) : increment_(stream * 2 + 1) {
    next();
    state_ += seed;
    next();
  }

  uint32_t next() {
    const uint64_t old = state_;
    state_ = old * 6364136223846793005u + increment_;
    const auto shifted = static_cast<uint32_t>(((old >> 18) ^ old) >> 27);
    const auto rotation = static_cast<uint32_t>(old >> 59);
    return (shifted >> rotation) | (shifted << ((32 - rotation) & 31));
  }

  /// In [0, 1): a multiple of 2^-24, so that the float is exact.
  float uniform() { return static_cast<float>(next() >> 8) * 0x1p-24f; }

  /// In [low, high).
  float uniform(float low, float high) { return low + (high - low) * uniform(); }

  /// In [0, bound), bound at least 1; biased by at most bound / 2^32.
  uint32_t below(uint32_t bound) { return static_cast<uint32_t>((uint64_t{next()} * bound) >> 32); }

 private:
  uint64_t state_ = 0;
  uint64_t increment_;
};

}  // namespace kiwami::tools
