// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <optional>
#include <vector>

#include "measure/library.h"
#include "measure/ray_sets.h"

namespace kiwami::tools {

/// What a scene answered to several ray sets: closest hits and any hits, set by set.
struct Answers {
  std::vector<std::vector<kiwami_hit>> hits;
  std::vector<std::vector<uint8_t>> occluded;
};

/// Traces each set in one call for closest hits and one for any hits.
Answers trace_answers(const BuiltScene& scene, const std::vector<RaySet>& sets);

/// Where two answers part.
struct Difference {
  size_t set;
  size_t ray;
  bool of_any_hit;  ///< the closest hits are equal, but any hit contradicts them
};

/// The first ray whose closest hit differs in any bit, or whose any hit does not say whether the
/// expected answers have a closest hit; nothing when there is none.
std::optional<Difference> first_difference(const Answers& expected, const Answers& answers);

}  // namespace kiwami::tools
