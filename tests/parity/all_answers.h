// SPDX-License-Identifier: Apache-2.0
// What every call that traces says of some rays, in batches and one ray a call.
#pragma once

#include <string>
#include <vector>

#include "kiwami/trace.h"

namespace kiwami_tests {

/// The answers of one call: records of a size.
struct NamedAnswers {
  std::string call;
  size_t record_size;
  std::vector<unsigned char> bytes;
};

/// Closest hits with their paths, any hits, counts, lists of the nearest three and of all; closest
/// hits and counts with a filter, and without what was met first. Throws where single rays and
/// batches do not agree.
std::vector<NamedAnswers> all_answers(const kiwami_scene* scene,
                                      const std::vector<kiwami_ray>& rays);

/// "" where they are equal to the bit.
std::string difference(const std::vector<NamedAnswers>& a, const std::vector<NamedAnswers>& b);

/// How many of the rays hit something.
size_t hit_count(const std::vector<NamedAnswers>& answers);

}  // namespace kiwami_tests
