// SPDX-License-Identifier: Apache-2.0
#include "kiwami/distribution.h"

#include "api/check.h"
#include "lights/distribution.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumStructSize = 8;
constexpr kiwami_distribution_desc kNoWeights{};

Distribution* object_of(kiwami_distribution* handle) {
  return reinterpret_cast<Distribution*>(handle);
}
const Distribution* object_of(const kiwami_distribution* handle) {
  return reinterpret_cast<const Distribution*>(handle);
}
const Device* device_of(const kiwami_distribution* distribution) {
  return distribution ? &object_of(distribution)->device() : nullptr;
}

size_t stride_or(uint64_t stride, size_t size) {
  return stride ? static_cast<size_t>(stride) : size;
}

kiwami_distribution_desc read_desc(const kiwami_distribution_desc* given) {
  const kiwami_distribution_desc desc =
      read_descriptor(given, kMinimumStructSize, "desc", kNoWeights);
  if (desc.method > KIWAMI_DISTRIBUTION_ALIAS_TABLE) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.method is %u, expected one of KIWAMI_DISTRIBUTION_*", desc.method);
  }
  if (desc.weight_count == 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.weight_count is 0, expected at least 1");
  }
  if (desc.weight_count > Distribution::kMaxWeightCount) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.weight_count is %llu, expected at most %llu",
                static_cast<unsigned long long>(desc.weight_count),
                static_cast<unsigned long long>(Distribution::kMaxWeightCount));
  }
  check_array("desc.weights", desc.weights, static_cast<size_t>(desc.weight_stride), sizeof(float),
              static_cast<size_t>(desc.weight_count));
  return desc;
}

template <typename Input, typename Output>
DistributionBatch batch_of(const Input* inputs, size_t input_stride, Output* outputs,
                           size_t output_stride, size_t count) {
  return {reinterpret_cast<const unsigned char*>(inputs), stride_or(input_stride, sizeof(Input)),
          reinterpret_cast<unsigned char*>(outputs), stride_or(output_stride, sizeof(Output)),
          count};
}

}  // namespace

extern "C" {

kiwami_result kiwami_distribution_desc_init(kiwami_distribution_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumStructSize, "desc", kNoWeights); });
}

kiwami_result kiwami_distribution_create(kiwami_device* device,
                                         const kiwami_distribution_desc* desc,
                                         kiwami_distribution** distribution) {
  if (distribution) *distribution = nullptr;
  return guarded(device ? kiwami::api::object_of(device) : nullptr, [&] {
    check_not_null(device, "device");
    check_not_null(distribution, "distribution");
    const kiwami_distribution_desc read = read_desc(desc);
    Distribution* const made = Distribution::create(*kiwami::api::object_of(device), read.method,
                                                    static_cast<const unsigned char*>(read.weights),
                                                    stride_or(read.weight_stride, sizeof(float)),
                                                    static_cast<size_t>(read.weight_count));
    *distribution = reinterpret_cast<kiwami_distribution*>(made);
  });
}

void kiwami_distribution_retain(kiwami_distribution* distribution) {
  if (distribution) object_of(distribution)->retain();
}

void kiwami_distribution_release(kiwami_distribution* distribution) {
  if (distribution) object_of(distribution)->release();
}

kiwami_result kiwami_distribution_get_info(const kiwami_distribution* distribution,
                                           kiwami_distribution_info* info) {
  return guarded(device_of(distribution), [&] {
    check_not_null(distribution, "distribution");
    check_not_null(info, "info");
    write_info(info, kMinimumStructSize, "info", object_of(distribution)->info());
  });
}

kiwami_result kiwami_distribution_sample(const kiwami_distribution* distribution,
                                         const double* randoms, size_t random_stride,
                                         kiwami_draw* draws, size_t draw_stride, size_t count) {
  return guarded(device_of(distribution), [&] {
    check_not_null(distribution, "distribution");
    if (count == 0) return;
    const Distribution& object = *object_of(distribution);
    if (object.device().validates_arguments()) {
      check_array("randoms", randoms, random_stride, sizeof(double), count);
      check_array("draws", draws, draw_stride, sizeof(kiwami_draw), count);
    }
    object.sample(batch_of(randoms, random_stride, draws, draw_stride, count));
  });
}

kiwami_result kiwami_distribution_pdf(const kiwami_distribution* distribution,
                                      const uint32_t* indices, size_t index_stride,
                                      float* probabilities, size_t probability_stride,
                                      size_t count) {
  return guarded(device_of(distribution), [&] {
    check_not_null(distribution, "distribution");
    if (count == 0) return;
    const Distribution& object = *object_of(distribution);
    if (object.device().validates_arguments()) {
      check_array("indices", indices, index_stride, sizeof(uint32_t), count);
      check_array("probabilities", probabilities, probability_stride, sizeof(float), count);
    }
    object.find_probabilities(
        batch_of(indices, index_stride, probabilities, probability_stride, count));
  });
}

}  // extern "C"
