// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>
#include <string>

#include "kiwami/trace.h"

namespace kiwami_tests {

/// Equal in every field to the bit.
inline bool is_same(const kiwami_hit& a, const kiwami_hit& b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// All fields, floats in hexadecimal, so that a failure can be run again from its message.
std::string describe(const kiwami_ray& ray);
std::string describe(const kiwami_hit& hit);

}  // namespace kiwami_tests
