// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

namespace kiwami {

/// A number drawn from a discrete distribution.
struct Draw {
  static constexpr double kGreatestRandom = 1.0 - 0x1p-53;

  uint32_t index;
  double random;  ///< anew, at least 0, at most kGreatestRandom
};

}  // namespace kiwami
