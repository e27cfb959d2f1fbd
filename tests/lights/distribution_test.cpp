// SPDX-License-Identifier: Apache-2.0
// Discrete distributions: the forest against a search in the cumulative sums, both methods and the
// alias table against their probabilities, and all that may be given to them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "lights/alias_table.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

struct ReleaseDistribution {
  void operator()(kiwami_distribution* handle) const { kiwami_distribution_release(handle); }
};
using Handle = std::unique_ptr<kiwami_distribution, ReleaseDistribution>;

kiwami_distribution_desc describe(const std::vector<float>& weights, uint32_t method) {
  kiwami_distribution_desc desc;
  check(kiwami_distribution_desc_init(&desc, sizeof desc));
  desc.method = method;
  desc.weights = weights.data();
  desc.weight_count = weights.size();
  return desc;
}

Handle make(kiwami_device* device, const std::vector<float>& weights, uint32_t method) {
  const kiwami_distribution_desc desc = describe(weights, method);
  kiwami_distribution* handle = nullptr;
  check(kiwami_distribution_create(device, &desc, &handle));
  return Handle(handle);
}

std::vector<kiwami_draw> sample(const Handle& distribution, const std::vector<double>& randoms) {
  std::vector<kiwami_draw> draws(randoms.size());
  check(kiwami_distribution_sample(distribution.get(), randoms.data(), 0, draws.data(), 0,
                                   randoms.size()));
  return draws;
}

std::vector<float> probabilities_of_all(const Handle& distribution, size_t count) {
  std::vector<uint32_t> indices(count);
  std::iota(indices.begin(), indices.end(), 0u);
  std::vector<float> probabilities(count);
  check(kiwami_distribution_pdf(distribution.get(), indices.data(), 0, probabilities.data(), 0,
                                count));
  return probabilities;
}

/// Where each weight's interval begins: sums of what stands before, of 1.
std::vector<double> cumulative(const std::vector<float>& weights) {
  std::vector<double> bounds;
  double sum = 0.0;
  for (const float weight : weights) {
    bounds.push_back(sum);
    sum += static_cast<double>(weight);
  }
  for (double& bound : bounds) bound /= sum;
  return bounds;
}

/// 0 <= result < 1, with all the bits of a double.
double uniform(Random& random) {
  const uint64_t high = random.bits();
  return static_cast<double>((high << 32 | random.bits()) >> 11) * 0x1p-53;
}

struct Weights {
  const char* name;
  std::vector<float> values;
};

std::vector<Weights> all_weights() {
  Random random(seed());
  std::vector<Weights> all = {
      {"one", {3.0f}},
      {"two", {1.0f, 2.0f}},
      {"zeros around one", {0.0f, 0.0f, 5.0f, 0.0f}},
      {"zeros between", {1.0f, 0.0f, 0.0f, 0.0f, 1.0f, 0.0f, 2.0f}},
      {"tiny and huge", {1e-38f, 3e38f, 1e-38f, 1e-45f, 3e38f}},
      {"last ones lost", {1.0f, 1e-30f, 1e-30f}},
  };
  for (const size_t count : {3u, 64u, 1000u, 40000u}) {
    Weights even{"even", std::vector<float>(count, 0.7f)}, mixed{"mixed", {}}, steep{"power", {}},
        crowd{"one cell for nearly all", {}};
    for (size_t i = 0; i < count; ++i) {
      mixed.values.push_back(random.unit() < 0.3f ? 0.0f : random.unit());
      steep.values.push_back(std::pow(random.unit(), 20.0f));
      crowd.values.push_back(i == 0 || i + 1 == count ? 1e6f : 1e-3f);
    }
    mixed.values[0] = 1.0f;
    steep.values[0] = 1.0f;
    all.insert(all.end(), {even, mixed, steep, crowd});
  }
  return all;
}

/// Random numbers at, just below and just above each bound, the ends, and some others.
std::vector<double> telling_numbers(const std::vector<double>& bounds, Random& random) {
  std::vector<double> numbers = {0.0, 0x1p-60, 0x1p-53, 0.5, 1.0 - 0x1p-24, 1.0 - 0x1p-53};
  for (const double bound : bounds) {
    for (const double number : {std::nextafter(bound, -1.0), bound, std::nextafter(bound, 2.0)}) {
      if (number >= 0.0 && number < 1.0) numbers.push_back(number);
    }
  }
  for (int i = 0; i < 1000; ++i) numbers.push_back(uniform(random));
  return numbers;
}

class DistributionTest : public testing::Test {
 protected:
  const DeviceHandle device_ = make_device(KIWAMI_ISA_AUTO, 2);
};

TEST_F(DistributionTest, TheForestIsTheInverseOfTheCumulativeSums) {
  Random random(seed());
  SCOPED_TRACE("KIWAMI_SEED=" + std::to_string(seed()));
  for (const Weights& weights : all_weights()) {
    SCOPED_TRACE(weights.name + std::string(", ") + std::to_string(weights.values.size()));
    const Handle forest =
        make(device_.get(), weights.values, KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST);
    const std::vector<double> bounds = cumulative(weights.values);
    const std::vector<double> numbers = telling_numbers(bounds, random);
    const std::vector<kiwami_draw> draws = sample(forest, numbers);
    for (size_t i = 0; i < numbers.size(); ++i) {
      const auto after = std::upper_bound(bounds.begin(), bounds.end(), numbers[i]);
      const auto expected = static_cast<uint32_t>(after - bounds.begin() - 1);
      ASSERT_EQ(draws[i].index, expected) << "random " << numbers[i];
      ASSERT_GT(weights.values[expected], 0.0f);
      const double upper = after == bounds.end() ? 1.0 : *after;
      const double stretched = (numbers[i] - bounds[expected]) / (upper - bounds[expected]);
      ASSERT_EQ(draws[i].random, std::min(stretched, 1.0 - 0x1p-53));
    }
  }
}

TEST_F(DistributionTest, ProbabilitiesAreThoseOfTheWeightsAndOfTheDraws) {
  Random random(seed());
  for (const uint32_t method :
       {KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST, KIWAMI_DISTRIBUTION_ALIAS_TABLE}) {
    for (const Weights& weights : all_weights()) {
      SCOPED_TRACE(weights.name + std::string(", method ") + std::to_string(method));
      const Handle handle = make(device_.get(), weights.values, method);
      const std::vector<float> probabilities = probabilities_of_all(handle, weights.values.size());
      const double total = std::accumulate(
          weights.values.begin(), weights.values.end(), 0.0,
          [](double sum, float weight) { return sum + static_cast<double>(weight); });
      for (size_t i = 0; i < probabilities.size(); ++i) {
        const double expected = static_cast<double>(weights.values[i]) / total;
        ASSERT_NEAR(static_cast<double>(probabilities[i]), expected, expected * 1e-6 + 1e-15) << i;
      }
      std::vector<double> numbers;
      for (int i = 0; i < 2000; ++i) numbers.push_back(uniform(random));
      for (const kiwami_draw& draw : sample(handle, numbers)) {
        ASSERT_GT(draw.probability, 0.0f);
        ASSERT_EQ(draw.probability, probabilities[draw.index]);
        ASSERT_GE(draw.random, 0.0);
        ASSERT_LT(draw.random, 1.0);
      }
    }
  }
}

/// Pearson's statistic of counts, over classes that are expected at least ten times.
double chi_square(const std::vector<uint32_t>& counts, const std::vector<float>& probabilities,
                  double draws, uint32_t& freedom) {
  double sum = 0.0, rest_expected = 0.0, rest = 0.0;
  freedom = 0;
  for (size_t i = 0; i < counts.size(); ++i) {
    const double expected = draws * static_cast<double>(probabilities[i]);
    if (expected < 10.0) {
      rest_expected += expected;
      rest += counts[i];
      continue;
    }
    sum += (counts[i] - expected) * (counts[i] - expected) / expected;
    ++freedom;
  }
  if (rest_expected >= 10.0) {
    sum += (rest - rest_expected) * (rest - rest_expected) / rest_expected;
    ++freedom;
  }
  freedom -= 1;
  return sum;
}

TEST_F(DistributionTest, DrawsFollowTheProbabilitiesAndLeaveUniformNumbers) {
  Random random(seed());
  SCOPED_TRACE("KIWAMI_SEED=" + std::to_string(seed()));
  const auto draw_count = static_cast<size_t>(ray_budget(400000));
  std::vector<float> weights;
  for (int i = 0; i < 300; ++i) weights.push_back(std::pow(random.unit(), 3.0f));
  for (const uint32_t method :
       {KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST, KIWAMI_DISTRIBUTION_ALIAS_TABLE}) {
    SCOPED_TRACE(method);
    const Handle handle = make(device_.get(), weights, method);
    std::vector<double> numbers(draw_count);
    for (double& number : numbers) number = uniform(random);
    std::vector<uint32_t> counts(weights.size()), parts(16);
    for (const kiwami_draw& draw : sample(handle, numbers)) {
      ++counts[draw.index];
      ++parts[static_cast<size_t>(draw.random * 16.0)];
    }
    // Beyond the mean by five standard deviations: once in some millions of runs.
    uint32_t freedom = 0;
    const double spread = chi_square(counts, probabilities_of_all(handle, weights.size()),
                                     static_cast<double>(draw_count), freedom);
    EXPECT_LT(spread, freedom + 5.0 * std::sqrt(2.0 * freedom));
    const double even = chi_square(parts, std::vector<float>(16, 1.0f / 16.0f),
                                   static_cast<double>(draw_count), freedom);
    EXPECT_LT(even, freedom + 6.0 * std::sqrt(2.0 * freedom));
  }
}

TEST_F(DistributionTest, BatchesStridesAndThreadsGiveTheSameBits) {
  Random random(seed());
  std::vector<float> weights;
  for (int i = 0; i < 5000; ++i) weights.push_back(random.unit());
  std::vector<double> numbers(100000);
  for (double& number : numbers) number = uniform(random);
  const DeviceHandle alone = make_device(KIWAMI_ISA_SCALAR, 1);
  for (const uint32_t method :
       {KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST, KIWAMI_DISTRIBUTION_ALIAS_TABLE}) {
    const std::vector<kiwami_draw> draws = sample(make(device_.get(), weights, method), numbers);
    const Handle other = make(alone.get(), weights, method);
    EXPECT_EQ(
        std::memcmp(draws.data(), sample(other, numbers).data(), draws.size() * sizeof draws[0]),
        0);
    constexpr size_t kIn = 13, kOut = 19, kCount = 1000;
    std::vector<unsigned char> in(kIn * kCount + 8), out(kOut * kCount + 16);
    for (size_t i = 0; i < kCount; ++i) std::memcpy(&in[1 + i * kIn], &numbers[i], 8);
    check(kiwami_distribution_sample(other.get(), reinterpret_cast<const double*>(&in[1]), kIn,
                                     reinterpret_cast<kiwami_draw*>(&out[3]), kOut, kCount));
    for (size_t i = 0; i < kCount; ++i) {
      ASSERT_EQ(std::memcmp(&out[3 + i * kOut], &draws[i], sizeof draws[i]), 0) << i;
    }
  }
}

TEST_F(DistributionTest, NumbersOutOfRangeCountAsTheNearest) {
  const double kNaN = std::numeric_limits<double>::quiet_NaN();
  const double kInfinity = std::numeric_limits<double>::infinity();
  for (const uint32_t method :
       {KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST, KIWAMI_DISTRIBUTION_ALIAS_TABLE}) {
    const Handle handle = make(device_.get(), {1.0f, 2.0f, 3.0f}, method);
    const std::vector<kiwami_draw> draws =
        sample(handle, {0.0, -1.0, kNaN, -kInfinity, 1.0 - 0x1p-53, 1.0, 7.0, kInfinity});
    for (int i = 1; i < 4; ++i) EXPECT_EQ(std::memcmp(&draws[0], &draws[i], sizeof draws[0]), 0);
    for (int i = 5; i < 8; ++i) EXPECT_EQ(std::memcmp(&draws[4], &draws[i], sizeof draws[0]), 0);
    const std::vector<uint32_t> beyond = {3, KIWAMI_INVALID_ID};
    std::vector<float> probabilities(2, 1.0f);
    check(kiwami_distribution_pdf(handle.get(), beyond.data(), 0, probabilities.data(), 0, 2));
    EXPECT_EQ(probabilities, std::vector<float>(2, 0.0f));
  }
}

TEST_F(DistributionTest, TheInfoCountsTheStepsOfDraws) {
  const Handle even =
      make(device_.get(), std::vector<float>(4096, 1.0f), KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST);
  kiwami_distribution_info info;
  info.struct_size = sizeof info;
  check(kiwami_distribution_get_info(even.get(), &info));
  EXPECT_EQ(info.weight_count, 4096u);
  EXPECT_EQ(info.total, 4096.0);
  // Each bound lies where a cell begins: one comparison, which the first cell does not need.
  EXPECT_NEAR(info.mean_steps, 1.0, 1e-3);
  EXPECT_EQ(info.most_steps, 1u);
  Random random(seed());
  std::vector<float> steep;
  for (int i = 0; i < 100000; ++i) steep.push_back(std::pow(random.unit(), 9.0f));
  const Handle forest = make(device_.get(), steep, KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST);
  check(kiwami_distribution_get_info(forest.get(), &info));
  EXPECT_GT(info.mean_steps, 0.1);
  EXPECT_LT(info.mean_steps, 3.0) << "a draw takes constant time on average";
  EXPECT_GT(info.most_steps, 8u) << "many small weights share the first cells";
  EXPECT_LE(info.most_steps, 96u);
  const Handle table = make(device_.get(), steep, KIWAMI_DISTRIBUTION_ALIAS_TABLE);
  check(kiwami_distribution_get_info(table.get(), &info));
  EXPECT_EQ(info.method, uint32_t{KIWAMI_DISTRIBUTION_ALIAS_TABLE});
  EXPECT_EQ(info.mean_steps, 1.0);
}

/// Expects a result and a sentence that holds some words.
void expect_error(kiwami_result result, kiwami_result expected, const char* words) {
  EXPECT_EQ(result, expected);
  char sentence[512];
  kiwami_last_error(nullptr, sentence, sizeof sentence);
  EXPECT_NE(std::string(sentence).find(words), std::string::npos) << sentence;
}

TEST_F(DistributionTest, BadArgumentsAreNamed) {
  kiwami_distribution* handle = nullptr;
  const auto create = [&](const std::vector<float>& weights) {
    const kiwami_distribution_desc desc = describe(weights, 0);
    return kiwami_distribution_create(device_.get(), &desc, &handle);
  };
  expect_error(create({}), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.weight_count is 0");
  expect_error(create({0.0f, 0.0f}), KIWAMI_ERROR_INVALID_ARGUMENT, "all 2 numbers");
  expect_error(create({1.0f, -1.0f}), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.weights[1] is -1");
  expect_error(create({1.0f, 2.0f, std::numeric_limits<float>::infinity()}),
               KIWAMI_ERROR_INVALID_ARGUMENT, "desc.weights[2] is inf");
  expect_error(create({std::nanf("")}), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.weights[0] is");
  EXPECT_EQ(handle, nullptr);
  const std::vector<float> weights = {1.0f};
  kiwami_distribution_desc desc = describe(weights, 2);
  const auto create_it = [&] { return kiwami_distribution_create(device_.get(), &desc, &handle); };
  expect_error(create_it(), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.method is 2");
  desc = describe(weights, 0);
  desc.weight_count = uint64_t{1} << 31;
  expect_error(create_it(), KIWAMI_ERROR_TOO_LARGE, "desc.weight_count is 2147483648");
  desc = describe(weights, 0);
  desc.weight_stride = 2;
  expect_error(create_it(), KIWAMI_ERROR_INVALID_ARGUMENT, "the stride of desc.weights is 2");
  desc = describe(weights, 0);
  desc.weights = nullptr;
  expect_error(create_it(), KIWAMI_ERROR_INVALID_ARGUMENT, "desc.weights is NULL");
  expect_error(kiwami_distribution_create(device_.get(), nullptr, &handle),
               KIWAMI_ERROR_INVALID_ARGUMENT, "desc is NULL");
  expect_error(kiwami_distribution_create(device_.get(), &desc, nullptr),
               KIWAMI_ERROR_INVALID_ARGUMENT, "distribution is NULL");
  expect_error(kiwami_distribution_sample(nullptr, nullptr, 0, nullptr, 0, 0),
               KIWAMI_ERROR_INVALID_ARGUMENT, "distribution is NULL");
  expect_error(kiwami_distribution_get_info(nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT,
               "distribution is NULL");
}

TEST(AliasTable, DrawsInProportionToWeights) {
  Random random(seed(), 655);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  kiwami::Memory memory(nullptr, nullptr, nullptr);
  for (const uint32_t count : {1u, 2u, 7u, 1000u}) {
    kiwami::Array<double> weights(memory, count);
    double total = 0.0;
    for (uint32_t i = 0; i < count; ++i) {
      weights[i] = random.one_in(3) ? 0.0 : std::exp2(20.0 * static_cast<double>(random.unit()));
      if (i == 0) weights[i] = 1.0;
      total += weights[i];
    }
    const kiwami::AliasTable table(weights, memory);
    // Along a fine grid, each number is drawn for its share of the grid's points.
    const uint32_t points = count * 2000;
    std::vector<uint32_t> seen(count, 0);
    for (uint32_t i = 0; i < points; ++i) {
      const auto draw = table.draw((i + 0.5) / points);
      ASSERT_LT(draw.index, count);
      ASSERT_TRUE(draw.random >= 0.0 && draw.random < 1.0);
      ++seen[draw.index];
    }
    for (uint32_t i = 0; i < count; ++i) {
      EXPECT_NEAR(table.probability(i), weights[i] / total, 1e-12);
      if (weights[i] == 0.0) {
        EXPECT_EQ(seen[i], 0u);
      }
      // Every entry that has a part of it may round by one point.
      EXPECT_NEAR(seen[i], table.probability(i) * points, count + 2.0) << i;
    }
    EXPECT_LT(table.draw(1.0 - 0x1p-53).index, count);
  }
  kiwami::Array<double> nothing(memory, 3);
  nothing.fill_zero();
  EXPECT_TRUE(kiwami::AliasTable(nothing, memory).empty());
}

}  // namespace
}  // namespace kiwami_tests
