// SPDX-License-Identifier: Apache-2.0
// The roulettes with blue-noise dithered numbers: uniform, a function of the pixel, and with errors
// that a filter takes away.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "lights/blue_noise.h"
#include "lights/light_scene.h"
#include "support/environment.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

TEST(RouletteNumbers, DitheredOnesAreUniformOverSeedsAndSamples) {
  Random random(seed(), 658);
  const auto draws = static_cast<int>(std::max<uint64_t>(4000, ray_budget(20000)));
  for (const uint64_t dimension : {uint64_t{0}, uint64_t{17}, uint64_t{1} << 41}) {
    std::vector<int> histogram(16, 0);
    int last_bits = 0;
    for (int i = 0; i < draws; ++i) {
      const uint64_t bits = kiwami::DitheredSource({3, 5, 2}, random.bits()).bits(dimension);
      ++histogram[bits >> 60];
      last_bits += static_cast<int>(bits & 1);
    }
    double square = 0.0;
    for (const int count : histogram) {
      square += (count - draws / 16.0) * (count - draws / 16.0) * 16.0 / draws;
    }
    EXPECT_LT(square, 60.0) << "dimension " << dimension << ", 15 degrees of freedom";
    EXPECT_NEAR(last_bits, draws / 2.0, 2.5 * std::sqrt(draws));
  }
}

TEST(RouletteNumbers, DitheredSamplesOfAPixelAreSpread) {
  // Of the first number no two of n are nearer than a third of 1 / n; of all others each interval
  // has about its share, and two of them do not rise together.
  constexpr uint32_t kSamples = 64;
  std::vector<double> first;
  for (uint32_t sample = 0; sample < kSamples; ++sample) {
    const kiwami::DitheredSource source({9, 1, sample}, 7);
    first.push_back(kiwami::number_of_bits(source.bits(kiwami::kFirstNumber)));
  }
  std::sort(first.begin(), first.end());
  for (size_t i = 1; i < kSamples; ++i) EXPECT_GT(first[i] - first[i - 1], 0.3 / kSamples);
  double unevenness = 0.0, correlation = 0.0;
  constexpr int kDimensions = 200;
  for (uint64_t dimension = 0; dimension < kDimensions; ++dimension) {
    double quarters[4] = {}, product = 0.0;
    for (uint32_t sample = 0; sample < kSamples; ++sample) {
      const kiwami::DitheredSource source({9, 1, sample}, 7);
      const double number = kiwami::number_of_bits(source.bits(dimension));
      quarters[static_cast<size_t>(4.0 * number)] += 1.0;
      product += (number - 0.5) * (kiwami::number_of_bits(source.bits(dimension + 1)) - 0.5);
    }
    for (const double count : quarters) {
      unevenness += (count - kSamples / 4.0) * (count - kSamples / 4.0) / kSamples / kDimensions;
    }
    correlation += std::fabs(12.0 * product / kSamples) / kDimensions;
  }
  // Independent numbers have 0.75 and about 0.1.
  EXPECT_LT(unevenness, 0.5);
  EXPECT_LT(correlation, 0.3);
}

/// The estimates of a picture's pixels: one light field over a plane that they look at.
struct DitheredPicture {
  static constexpr uint32_t kEdge = 64;

  explicit DitheredPicture(uint32_t chosen) : method(chosen) {
    Random random(seed(), 659);
    // Enough lights that some number is decided at each pixel, all above the plane.
    for (int i = 0; i < 24; ++i) {
      kiwami_light light{};
      light.points[0] = random.symmetric();
      light.points[1] = random.symmetric();
      light.points[2] = 1.0f + random.unit();
      light.power = 1.0f + random.unit();
      light.link_mask = ~uint64_t{0};
      scene.lights.push_back(light);
    }
    tree = make_light_tree(device.get(), scene, 8);
    lights = scene.seen();
    for (uint32_t i = 0; i < kEdge * kEdge; ++i) {
      kiwami_light_receiver receiver{};
      const uint32_t x = i % kEdge, y = i / kEdge;
      receiver.position[0] = static_cast<float>(x) / kEdge - 0.5f;
      receiver.position[1] = static_cast<float>(y) / kEdge - 0.5f;
      receiver.normal[2] = 1.0f;
      receiver.link_mask = ~uint64_t{0};
      receiver.random = (random.bits() + 0.5) * 0x1p-32;
      receivers.push_back(receiver);
      pixels.push_back({x, y, 0});
    }
  }

  std::vector<kiwami_light_choice> choices(uint32_t sequence, uint32_t picture_seed) const {
    kiwami_light_query query;
    check(kiwami_light_query_init(&query, sizeof query));
    query.method = method;
    query.max_choices = 32;
    query.sequence = sequence;
    query.sequence_seed = picture_seed;
    query.pixels = pixels.data();
    std::vector<kiwami_light_choice> choices(32 * receivers.size());
    check(kiwami_light_sample(tree.get(), receivers.data(), 0, choices.data(), 0, receivers.size(),
                              &query));
    return choices;
  }

  /// The error of each pixel, relative to what is right.
  std::vector<double> errors(uint32_t sequence, uint32_t picture_seed) const {
    const std::vector<kiwami_light_choice> all = choices(sequence, picture_seed);
    std::vector<double> errors(receivers.size());
    for (size_t i = 0; i < receivers.size(); ++i) {
      double expected = 0.0, estimate = 0.0;
      for (const SeenLight& light : lights) expected += contribution(light, receivers[i]);
      for (size_t k = 32 * i; all[k].light_id != KIWAMI_INVALID_ID; ++k) {
        estimate += contribution(lights[all[k].light_id], receivers[i]) /
                    static_cast<double>(all[k].probability);
      }
      errors[i] = estimate / expected - 1.0;
    }
    return errors;
  }

  uint32_t method;
  DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  LightScene scene;
  LightTreeHandle tree;
  std::vector<SeenLight> lights;
  std::vector<kiwami_light_receiver> receivers;
  std::vector<kiwami_light_pixel> pixels;
};

/// The mean square after a filter that averages squares of `size` pixels.
double filtered_square(const std::vector<double>& errors, uint32_t size) {
  constexpr uint32_t kEdge = DitheredPicture::kEdge;
  double sum = 0.0;
  for (uint32_t y = 0; y + size <= kEdge; y += size) {
    for (uint32_t x = 0; x + size <= kEdge; x += size) {
      double mean = 0.0;
      for (uint32_t i = 0; i < size * size; ++i) {
        mean += errors[(y + i / size) * kEdge + x + i % size] / (size * size);
      }
      sum += mean * mean;
    }
  }
  const uint32_t squares = kEdge / size;
  return sum / (squares * squares);
}

class DitheredRoulette : public testing::TestWithParam<uint32_t> {};

TEST_P(DitheredRoulette, ErrorsOfNeighboursDiffer) {
  RecordProperty("seed", std::to_string(seed()));
  const DitheredPicture picture(GetParam());
  double plain[2] = {}, filtered[2] = {}, mean = 0.0;
  const auto pictures = static_cast<uint32_t>(std::max<uint64_t>(4, ray_budget(8)));
  for (uint32_t number = 0; number < pictures; ++number) {
    const std::vector<double> dithered = picture.errors(KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE, number);
    for (const double error : dithered) mean += error / (dithered.size() * pictures);
    plain[1] += filtered_square(dithered, 1) / pictures;
    filtered[1] += filtered_square(dithered, 4) / pictures;
  }
  const std::vector<double> white = picture.errors(KIWAMI_LIGHT_SEQUENCE_RANDOM, 0);
  plain[0] = filtered_square(white, 1);
  filtered[0] = filtered_square(white, 4);
  RecordProperty("error", std::to_string(plain[0]) + " " + std::to_string(plain[1]));
  RecordProperty("filtered", std::to_string(filtered[0]) + " " + std::to_string(filtered[1]));
  // As much error in all, and no bias, but less that a filter leaves.
  EXPECT_NEAR(plain[1] / plain[0], 1.0, 0.2);
  EXPECT_LT(filtered[1], 0.6 * filtered[0]);
  EXPECT_LT(std::fabs(mean), 0.02);
  std::printf("filtered error: %g random, %g dithered\n", filtered[0], filtered[1]);
}

TEST_P(DitheredRoulette, IsAFunctionOfPixelAndSeed) {
  DitheredPicture picture(GetParam());
  const auto dithered = [&](uint32_t picture_seed) {
    return picture.choices(KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE, picture_seed);
  };
  const auto ids = [](const std::vector<kiwami_light_choice>& choices) {
    std::vector<uint32_t> all;
    all.reserve(choices.size());
    for (const kiwami_light_choice& choice : choices) all.push_back(choice.light_id);
    return all;
  };
  const std::vector<uint32_t> first = ids(dithered(1));
  EXPECT_NE(first, ids(dithered(2)));
  // Whatever the random numbers are.
  for (kiwami_light_receiver& receiver : picture.receivers) receiver.random *= 0.7;
  EXPECT_EQ(first, ids(dithered(1)));
  for (kiwami_light_pixel& pixel : picture.pixels) ++pixel.sample;
  EXPECT_NE(first, ids(dithered(1)));
  kiwami_light_query query;
  check(kiwami_light_query_init(&query, sizeof query));
  query.method = GetParam();
  query.max_choices = 4;
  query.sequence = KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE;
  kiwami_light_choice choices[4];
  EXPECT_EQ(
      kiwami_light_sample(picture.tree.get(), picture.receivers.data(), 0, choices, 0, 1, &query),
      KIWAMI_ERROR_INVALID_ARGUMENT);
  query.sequence = 2;
  EXPECT_EQ(
      kiwami_light_sample(picture.tree.get(), picture.receivers.data(), 0, choices, 0, 1, &query),
      KIWAMI_ERROR_INVALID_ARGUMENT);
}

INSTANTIATE_TEST_SUITE_P(All, DitheredRoulette,
                         testing::Values(KIWAMI_LIGHT_METHOD_ROULETTE,
                                         KIWAMI_LIGHT_METHOD_LAZY_ROULETTE),
                         [](const auto& each) {
                           return each.param == KIWAMI_LIGHT_METHOD_ROULETTE ? "roulette" : "lazy";
                         });

}  // namespace
}  // namespace kiwami_tests
