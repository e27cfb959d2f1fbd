// SPDX-License-Identifier: Apache-2.0
#include "lights/distribution.h"

#include <algorithm>
#include <cstring>
#include <limits>

#include "core/error.h"
#include "math/float_environment.h"

namespace kiwami {
namespace {

/// Elements that one task answers; fewer than two tasks stay on the calling thread.
constexpr size_t kBlockSize = 16384;

template <typename T>
T read(const unsigned char* from) {
  T value;
  std::memcpy(&value, from, sizeof value);
  return value;
}

template <typename T>
void write(unsigned char* to, const T& value) {
  std::memcpy(to, &value, sizeof value);
}

Array<double> read_weights(const unsigned char* weights, size_t stride, size_t count,
                           Memory& memory) {
  Array<double> read_weights(memory, count);
  bool has_weight = false;
  for (size_t i = 0; i < count; ++i) {
    const float weight = read<float>(weights + i * stride);
    if (!(weight >= 0.0f && weight <= std::numeric_limits<float>::max())) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "desc.weights[%zu] is %g, expected 0 or more, finite", i,
                  static_cast<double>(weight));
    }
    has_weight = has_weight || weight > 0.0f;
    read_weights[i] = static_cast<double>(weight);
  }
  if (!has_weight) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "all %zu numbers of desc.weights are 0, expected one above 0", count);
  }
  return read_weights;
}

double clamped(double random) {
  return random > 0.0 ? std::min(random, Draw::kGreatestRandom) : 0.0;
}

/// Calls answer(input, output) for each element, in blocks on the device's threads where there are
/// many.
template <typename Answer>
void for_elements(const Parallel& parallel, const DistributionBatch& batch, Answer&& answer) {
  const auto answer_block = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      answer(batch.inputs + i * batch.input_stride, batch.outputs + i * batch.output_stride);
    }
  };
  if (batch.count < 2 * kBlockSize || parallel.width() == 1) {
    const DefaultFloatEnvironment environment;
    answer_block(0, batch.count);
  } else {
    parallel.for_blocks(batch.count, kBlockSize, answer_block);
  }
}

}  // namespace

Distribution* Distribution::create(Device& device, uint32_t method, const unsigned char* weights,
                                   size_t stride, size_t count) {
  const DefaultFloatEnvironment environment;
  return make_object<Distribution>(device.memory(), device, method,
                                   read_weights(weights, stride, count, device.memory()));
}

void Distribution::destroy(Distribution* distribution) noexcept {
  const Reference<Device> device = distribution->device_;
  destroy_object(device->memory(), distribution);
}

Distribution::Distribution(Device& device, uint32_t method, const Array<double>& weights)
    : device_(device),
      method_(method),
      weight_count_(static_cast<uint32_t>(weights.size())),
      total_(0.0) {
  for (const double weight : weights) total_ += weight;
  if (method == KIWAMI_DISTRIBUTION_ALIAS_TABLE) {
    table_ = AliasTable(weights, device.memory());
  } else {
    forest_ = RadixTreeForest(weights, device.memory(), device.parallel());
  }
}

kiwami_distribution_info Distribution::info() const {
  const DefaultFloatEnvironment environment;
  kiwami_distribution_info info{};
  info.method = method_;
  info.weight_count = weight_count_;
  info.bytes = sizeof *this + forest_.bytes() + table_.bytes();
  info.total = total_;
  const RadixTreeForest::Steps steps =
      method_ == KIWAMI_DISTRIBUTION_ALIAS_TABLE ? RadixTreeForest::Steps{1.0, 1} : forest_.steps();
  info.mean_steps = steps.mean;
  info.most_steps = steps.most;
  return info;
}

/// A probability above 0 stays so: a float holds less than a double.
float Distribution::probability(uint32_t index) const {
  const double exact = method_ == KIWAMI_DISTRIBUTION_ALIAS_TABLE ? table_.probability(index)
                                                                  : forest_.probability(index);
  if (!(exact > 0.0)) return 0.0f;
  return std::max(static_cast<float>(exact), std::numeric_limits<float>::min());
}

void Distribution::sample(const DistributionBatch& batch) const {
  const auto sample_by = [&](const auto& method) {
    for_elements(device_->parallel(), batch, [&](const unsigned char* from, unsigned char* to) {
      const Draw draw = method.draw(clamped(read<double>(from)));
      write(to, kiwami_draw{draw.index, probability(draw.index), draw.random});
    });
  };
  if (method_ == KIWAMI_DISTRIBUTION_ALIAS_TABLE) {
    sample_by(table_);
  } else {
    sample_by(forest_);
  }
}

void Distribution::find_probabilities(const DistributionBatch& batch) const {
  for_elements(device_->parallel(), batch, [&](const unsigned char* from, unsigned char* to) {
    const auto index = read<uint32_t>(from);
    write(to, index < weight_count_ ? probability(index) : 0.0f);
  });
}

}  // namespace kiwami
