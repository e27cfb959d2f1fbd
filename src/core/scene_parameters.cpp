// SPDX-License-Identifier: Apache-2.0
#include "core/scene_parameters.h"

#include <algorithm>

#include "core/error.h"
#include "core/pipeline.h"

namespace kiwami {

namespace {

constexpr uint32_t kLastParameter = KIWAMI_PARAMETER_BUILDER;

/// By number; number 0 names nothing.
constexpr ParameterBounds kBounds[kLastParameter + 1] = {
    {0, 0, 0, true},
    {0, 16, 0, true},                   // BVH_WIDTH
    {0, 1, 1, true},                    // MERGE_LEAVES
    {1, 64, 8, true},                   // MERGE_RING
    {4, 32, 16, true},                  // BIN_COUNT
    {0, 16, 0, true},                   // MAX_LEAF_SIZE
    {0.01, 100.0, 1.0, false},          // NODE_COST
    {0.01, 100.0, 1.0, false},          // LEAF_COST
    {0, 1, 0, true},                    // VALIDATE_BUILD
    {0, 1, 1, true},                    // CONTRACTION
    {0, KIWAMI_BUILDER_PLOC, 0, true},  // BUILDER
};

/// Throws unless a method of this stage has the number.
void check_method(uint32_t stage, const char* stage_name, double number) {
  if (method_name(stage, static_cast<uint32_t>(number))) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "there is no %s of number %g, expected one that kiwami_method_name names", stage_name,
              number);
}

bool is_whole(double value) {
  // Within the bounds of every parameter of whole numbers, so that the conversion is defined.
  return static_cast<double>(static_cast<uint32_t>(value)) == value;
}

}  // namespace

const ParameterBounds& parameter_bounds(uint32_t parameter) {
  if (parameter == 0 || parameter > kLastParameter) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "parameter is %u, expected one of KIWAMI_PARAMETER_* (1 to %u)", parameter,
                kLastParameter);
  }
  return kBounds[parameter];
}

SceneParameters::SceneParameters() {
  for (uint32_t parameter = 0; parameter <= kLastParameter; ++parameter) {
    values_[parameter] = kBounds[parameter].preset;
  }
}

void SceneParameters::set(uint32_t parameter, double value) {
  const ParameterBounds& bounds = parameter_bounds(parameter);
  if (!(bounds.lowest <= value && value <= bounds.highest)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "value is %g for parameter %u, expected %g to %g",
                value, parameter, bounds.lowest, bounds.highest);
  }
  if (bounds.is_whole && !is_whole(value)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "value is %g for parameter %u, expected a whole number from %g to %g", value,
                parameter, bounds.lowest, bounds.highest);
  }
  const bool is_width = parameter == KIWAMI_PARAMETER_BVH_WIDTH;
  if (is_width && value != 0 && value != 4 && value != 8 && value != 16) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "value is %g for KIWAMI_PARAMETER_BVH_WIDTH, expected 0, 4, 8 or 16", value);
  }
  if (parameter == KIWAMI_PARAMETER_BUILDER) check_method(KIWAMI_STAGE_BUILDER, "builder", value);
  if (parameter == KIWAMI_PARAMETER_CONTRACTION) {
    check_method(KIWAMI_STAGE_CONTRACTION, "contraction", value);
  }
  values_[parameter] = value;
}

void SceneParameters::set_optimizers(std::span<const uint32_t> methods) {
  if (methods.size() > KIWAMI_MAX_OPTIMIZERS) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "count is %zu, expected at most %d optimizers",
                methods.size(), KIWAMI_MAX_OPTIMIZERS);
  }
  for (const uint32_t method : methods) check_method(KIWAMI_STAGE_OPTIMIZER, "optimizer", method);
  std::copy(methods.begin(), methods.end(), optimizers_);
  optimizer_count_ = methods.size();
}

}  // namespace kiwami
