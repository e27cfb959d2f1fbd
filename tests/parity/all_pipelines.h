// SPDX-License-Identifier: Apache-2.0
// Every pipeline: each builder alone and with each optimiser that it can have.
#pragma once

#include <string>
#include <vector>

#include "support/library.h"

namespace kiwami_tests {

struct Pipeline {
  uint32_t builder;
  std::vector<uint32_t> optimizers;

  std::string name() const;
  /// With the validator after each stage, and few representative rays, since sampling them takes
  /// longer than a small build. What else can be chosen goes round with the number, so that any 36
  /// consecutive ones hold each combination.
  BuildOptions options(uint32_t number, const std::vector<kiwami_ray>& rays) const;
};

std::vector<Pipeline> all_pipelines();

}  // namespace kiwami_tests
