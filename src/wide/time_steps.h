// SPDX-License-Identifier: Apache-2.0
// Steps of time: the same for kernels and baseline code.
#pragma once

#include <cstdint>

namespace kiwami {

/// Equal steps of time.
struct TimeSteps {
  float begin, end;
  uint32_t segment_count;  ///< steps but one
};

/// Where a time lies among steps.
struct TimePlace {
  uint32_t segment;
  float fraction;  ///< of the way through it, 0 to 1
};

/// False where a time lies outside, or is NaN.
// Always inlined: objects of several instruction sets must not share one copy.
__attribute__((always_inline)) inline bool place_in_time(const TimeSteps& steps, float time,
                                                         TimePlace& place) {
  if (!(steps.begin <= time && time <= steps.end)) return false;
  const float count = static_cast<float>(steps.segment_count);
  const float last = count - 1.0f;
  const float s = (time - steps.begin) / (steps.end - steps.begin) * count;
  place.segment = static_cast<uint32_t>(s < last ? s : last);
  place.fraction = s - static_cast<float>(place.segment);
  return true;
}

}  // namespace kiwami
