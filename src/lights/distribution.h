// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/device.h"
#include "core/object.h"
#include "kiwami/distribution.h"
#include "lights/alias_table.h"
#include "lights/radix_tree_forest.h"

namespace kiwami {

/// Elements of a batch: random numbers in and draws out, or indices in and probabilities out.
struct DistributionBatch {
  const unsigned char* inputs;
  size_t input_stride;
  unsigned char* outputs;
  size_t output_stride;
  size_t count;
};

/// A discrete distribution, by one of the methods. Never changed again.
class Distribution : public Object<Distribution> {
 public:
  static constexpr uint64_t kMaxWeightCount = 0x7FFFFFFF;

  /// weights are floats, count of them, stride bytes apart. Throws Error(INVALID_ARGUMENT) that
  /// names a weight, Error(OUT_OF_MEMORY or CALLBACK).
  static Distribution* create(Device& device, uint32_t method, const unsigned char* weights,
                              size_t stride, size_t count);
  static void destroy(Distribution* distribution) noexcept;

  Distribution(Device& device, uint32_t method, const Array<double>& weights);

  Device& device() const { return *device_; }
  kiwami_distribution_info info() const;

  void sample(const DistributionBatch& batch) const;
  void find_probabilities(const DistributionBatch& batch) const;

 private:
  float probability(uint32_t index) const;

  Reference<Device> device_;
  uint32_t method_;
  uint32_t weight_count_;
  double total_;
  RadixTreeForest forest_;
  AliasTable table_;
};

}  // namespace kiwami
