// SPDX-License-Identifier: Apache-2.0
#include "parity/all_pipelines.h"

namespace kiwami_tests {
namespace {

/// The numbers that name a method of a stage.
std::vector<uint32_t> methods_of(uint32_t stage) {
  std::vector<uint32_t> methods;
  for (uint32_t method = 0; method < 256; ++method) {
    if (kiwami_method_name(stage, method)) methods.push_back(method);
  }
  return methods;
}

bool acts_on_wide_tree(uint32_t optimizer) {
  return optimizer == KIWAMI_OPTIMIZER_REORDER_SATO || optimizer == KIWAMI_OPTIMIZER_REORDER_NARY;
}

}  // namespace

std::string Pipeline::name() const {
  std::string text = kiwami_method_name(KIWAMI_STAGE_BUILDER, builder);
  for (const uint32_t optimizer : optimizers) {
    text += std::string(" + ") + kiwami_method_name(KIWAMI_STAGE_OPTIMIZER, optimizer);
  }
  return text;
}

BuildOptions Pipeline::options(uint32_t number, const std::vector<kiwami_ray>& rays) const {
  static const std::vector<uint32_t> kContractions = methods_of(KIWAMI_STAGE_CONTRACTION);
  constexpr uint32_t kWidths[] = {4, 8, 16};
  const auto count = static_cast<uint32_t>(kContractions.size());
  BuildOptions options;
  options.width = kWidths[number % 3];
  options.merges_leaves = number / 3 % 2 == 0;
  options.validates = true;
  options.parameters = {{KIWAMI_PARAMETER_BUILDER, builder},
                        {KIWAMI_PARAMETER_CONTRACTION, kContractions[number / 6 % count]}};
  if (number / (6 * count) % 2 != 0) {
    options.parameters.emplace_back(KIWAMI_PARAMETER_LAYOUT, KIWAMI_LAYOUT_COMPACT);
  }
  options.optimizers = optimizers;
  options.representative_rays = rays;
  return options;
}

std::vector<Pipeline> all_pipelines() {
  std::vector<Pipeline> pipelines;
  for (const uint32_t builder : methods_of(KIWAMI_STAGE_BUILDER)) {
    pipelines.push_back({builder, {}});
    for (const uint32_t optimizer : methods_of(KIWAMI_STAGE_OPTIMIZER)) {
      // It has no binary tree, ever; others that make a wide tree make a binary one where it is asked.
      if (builder == KIWAMI_BUILDER_WIDE_BOTTOM_UP && !acts_on_wide_tree(optimizer)) continue;
      pipelines.push_back({builder, {optimizer}});
    }
  }
  return pipelines;
}

}  // namespace kiwami_tests
