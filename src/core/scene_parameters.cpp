// SPDX-License-Identifier: Apache-2.0
#include "core/scene_parameters.h"

#include <algorithm>
#include <iterator>

#include "core/error.h"
#include "core/pipeline.h"

namespace kiwami {

namespace {

struct NumberedBounds {
  uint32_t parameter;
  ParameterBounds bounds;
};

/// The numbers have gaps. Where a method is chosen, the highest bound is its stage's highest
/// number.
constexpr NumberedBounds kBounds[] = {
    {KIWAMI_PARAMETER_BVH_WIDTH, {0, 16, 0, true}},
    {KIWAMI_PARAMETER_MERGE_LEAVES, {0, 1, 1, true}},
    {KIWAMI_PARAMETER_MERGE_RING, {1, 64, 8, true}},
    {KIWAMI_PARAMETER_BIN_COUNT, {4, 32, 16, true}},
    {KIWAMI_PARAMETER_MAX_LEAF_SIZE, {0, 16, 0, true}},
    {KIWAMI_PARAMETER_NODE_COST, {0.01, 100.0, 1.0, false}},
    {KIWAMI_PARAMETER_LEAF_COST, {0.01, 100.0, 1.0, false}},
    {KIWAMI_PARAMETER_VALIDATE_BUILD, {0, 1, 0, true}},
    {KIWAMI_PARAMETER_CONTRACTION, {0, 0, KIWAMI_CONTRACTION_OPTIMAL, true}},
    {KIWAMI_PARAMETER_BUILDER, {0, 0, KIWAMI_BUILDER_BINNED_SAH, true}},
    {KIWAMI_PARAMETER_SPLIT_BUDGET, {0.0, 4.0, 0.3, false}},
    {KIWAMI_PARAMETER_SPLIT_ALPHA, {0.0, 1.0, 1e-5, false}},
    {KIWAMI_PARAMETER_BIN_HALVING, {0, 32, 0, true}},
    {KIWAMI_PARAMETER_REASSIGN, {0, 1, 0, true}},
    {KIWAMI_PARAMETER_AAC_QUALITY, {0, 1, 1, true}},
    {KIWAMI_PARAMETER_CURVE_CODE, {0, 1, 0, true}},
    {KIWAMI_PARAMETER_LBVH_DELTA, {0, 1, 0, true}},
    {KIWAMI_PARAMETER_LBVH_CHUNK_SIZE, {1, 16, 1, true}},
    {KIWAMI_PARAMETER_LAYOUT, {0, 1, KIWAMI_LAYOUT_FAST, true}},
    {KIWAMI_PARAMETER_TWO_LEVEL, {0, 1, 0, true}},
    {KIWAMI_PARAMETER_QUALITY, {0, 2, KIWAMI_QUALITY_BALANCED, true}},
    {KIWAMI_PARAMETER_REBRAID, {0, 2, KIWAMI_REBRAID_OFF, true}},
    {KIWAMI_PARAMETER_REBRAID_BUDGET, {0.0, 64.0, 2.0, false}},
    {KIWAMI_PARAMETER_DIVIDE_TIME, {0, 1, 1, true}},
};

constexpr uint32_t kBalancedOptimizers[] = {KIWAMI_OPTIMIZER_REORDER_SATO};
constexpr uint32_t kBestOptimizers[] = {KIWAMI_OPTIMIZER_PARALLEL_REINSERTION,
                                        KIWAMI_OPTIMIZER_REORDER_NARY};

/// By number.
constexpr QualityMethods kQualities[] = {
    {KIWAMI_BUILDER_WIDE_TOP_DOWN, kBalancedOptimizers, KIWAMI_CONTRACTION_OPTIMAL},
    {KIWAMI_BUILDER_WIDE_LINEAR, {}, KIWAMI_CONTRACTION_OPTIMAL},
    {KIWAMI_BUILDER_TRIAL, kBestOptimizers, KIWAMI_CONTRACTION_OPTIMAL},
};

/// The stage whose method a parameter chooses; 0: it chooses none.
uint32_t stage_of(uint32_t parameter) {
  switch (parameter) {
    case KIWAMI_PARAMETER_CONTRACTION:
      return KIWAMI_STAGE_CONTRACTION;
    case KIWAMI_PARAMETER_BUILDER:
      return KIWAMI_STAGE_BUILDER;
    default:
      return 0;
  }
}

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

ParameterBounds parameter_bounds(uint32_t parameter) {
  for (const NumberedBounds& known : kBounds) {
    if (known.parameter != parameter) continue;
    ParameterBounds bounds = known.bounds;
    if (const uint32_t stage = stage_of(parameter)) bounds.highest = highest_method(stage);
    return bounds;
  }
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "parameter is %u, expected one of KIWAMI_PARAMETER_*",
              parameter);
}

bool is_parameter(uint32_t parameter) {
  return std::any_of(
      std::begin(kBounds), std::end(kBounds),
      [parameter](const NumberedBounds& known) { return known.parameter == parameter; });
}

const QualityMethods& quality_methods(uint32_t quality) {
  if (quality >= std::size(kQualities)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "quality is %u, expected one of KIWAMI_QUALITY_*",
                quality);
  }
  return kQualities[quality];
}

SceneParameters::SceneParameters() {
  for (const NumberedBounds& known : kBounds) values_[known.parameter] = known.bounds.preset;
  set(KIWAMI_PARAMETER_QUALITY, KIWAMI_QUALITY_BALANCED);
}

void SceneParameters::set(uint32_t parameter, double value) {
  const ParameterBounds bounds = parameter_bounds(parameter);
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
  if (parameter == KIWAMI_PARAMETER_QUALITY) {
    const QualityMethods& methods = quality_methods(whole(parameter));
    values_[KIWAMI_PARAMETER_BUILDER] = methods.builder;
    values_[KIWAMI_PARAMETER_CONTRACTION] = methods.contraction;
    set_optimizers(methods.optimizers);
  }
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

bool SceneParameters::operator==(const SceneParameters& other) const {
  return std::equal(std::begin(values_), std::end(values_), std::begin(other.values_)) &&
         std::equal(optimizers_, optimizers_ + optimizer_count_, other.optimizers_,
                    other.optimizers_ + other.optimizer_count_);
}

}  // namespace kiwami
