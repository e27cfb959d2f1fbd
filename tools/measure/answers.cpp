// SPDX-License-Identifier: Apache-2.0
#include "measure/answers.h"

#include <cstring>

namespace kiwami::tools {

Answers trace_answers(const BuiltScene& scene, const std::vector<RaySet>& sets) {
  Answers answers;
  for (const RaySet& set : sets) {
    answers.hits.emplace_back(set.rays.size());
    answers.occluded.emplace_back(set.rays.size());
    scene.closest_hits(set.rays, answers.hits.back());
    scene.any_hits(set.rays, answers.occluded.back());
  }
  return answers;
}

std::optional<Difference> first_difference(const Answers& expected, const Answers& answers) {
  for (size_t set = 0; set < expected.hits.size(); ++set) {
    for (size_t ray = 0; ray < expected.hits[set].size(); ++ray) {
      const kiwami_hit& hit = expected.hits[set][ray];
      if (std::memcmp(&hit, &answers.hits[set][ray], sizeof hit) != 0) {
        return Difference{set, ray, false};
      }
      if (answers.occluded[set][ray] != (is_hit(hit) ? 1 : 0)) return Difference{set, ray, true};
    }
  }
  return std::nullopt;
}

}  // namespace kiwami::tools
