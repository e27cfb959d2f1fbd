// SPDX-License-Identifier: Apache-2.0
// What receivers choose: probabilities that sum to 1 and that samples follow, never 0 for a light
// that contributes, the same to the bit on every ISA.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "lights/light_scene.h"
#include "support/environment.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

constexpr uint32_t kWidths[] = {2, 4, 8, 16};

kiwami_light_choice sample(const LightTreeHandle& tree, const kiwami_light_receiver& receiver) {
  kiwami_light_choice choice;
  check(kiwami_light_sample(tree.get(), &receiver, 0, &choice, 0, 1, nullptr));
  return choice;
}

/// The probabilities of all lights.
std::vector<float> probabilities(const LightTreeHandle& tree, const std::vector<SeenLight>& lights,
                                 const kiwami_light_receiver& receiver) {
  const std::vector<kiwami_light_receiver> receivers(lights.size(), receiver);
  std::vector<float> result(lights.size());
  check(kiwami_light_pdf(tree.get(), receivers.data(), 0, &lights[0].name, sizeof(SeenLight),
                         result.data(), 0, lights.size(), nullptr));
  return result;
}

size_t index_of(const std::vector<SeenLight>& lights, const kiwami_light_choice& choice) {
  for (size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].name.light_id == choice.light_id &&
        lights[i].name.instance_id == choice.instance_id) {
      return i;
    }
  }
  ADD_FAILURE() << "no light " << choice.light_id << " of instance " << choice.instance_id;
  return 0;
}

/// Scenes of every kind: distant lights, groups, link masks, and none of these.
LightScene scene_number(uint32_t number, Random& random) {
  LightSceneOptions options;
  options.light_count = number % 5 == 4 ? 3 : 120;
  options.group_count = number % 2 == 0 ? 3 : 0;
  options.distant_count = number % 3 == 0 ? 4 : 0;
  options.has_link_masks = number % 4 == 1;
  return random_light_scene(options, random);
}

kiwami_light_receiver receiver_of(const LightScene& scene, uint32_t number, Random& random) {
  kiwami_light_receiver receiver = random_receiver(scene, random);
  if (number % 4 == 1 && !random.one_in(3)) receiver.link_mask = uint64_t{1} << random.below(6);
  return receiver;
}

TEST(LightSampling, ProbabilitiesSumToOneAndNoContributingLightHasNone) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 620);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  uint64_t dark = 0, total = 0;
  for (uint32_t number = 0; number < 12; ++number) {
    const LightScene scene = scene_number(number, random);
    const std::vector<SeenLight> lights = scene.seen();
    const LightTreeHandle tree =
        make_light_tree(device.get(), scene, kWidths[number % 4], number / 4 % 2);
    for (uint64_t i = 0; i < ray_budget(400); ++i) {
      const kiwami_light_receiver receiver = receiver_of(scene, number, random);
      const std::vector<float> p = probabilities(tree, lights, receiver);
      double sum = 0.0;
      for (size_t light = 0; light < lights.size(); ++light) {
        sum += static_cast<double>(p[light]);
        if (p[light] > 0.0f) continue;
        ASSERT_EQ(contribution(lights[light], receiver), 0.0)
            << "light " << light << " of type " << lights[light].light.type << ", scene " << number
            << ", receiver " << i << ", seed " << seed();
      }
      ++total;
      if (sum == 0.0) {
        ++dark;
        EXPECT_EQ(sample(tree, receiver).light_id, KIWAMI_INVALID_ID);
      } else {
        ASSERT_NEAR(sum, 1.0, 1e-4) << "scene " << number << ", receiver " << i;
      }
    }
  }
  EXPECT_LT(dark, total / 4);
}

TEST(LightSampling, PdfIsTheProbabilityOfTheSampleToTheBit) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 621);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  for (uint32_t number = 0; number < 12; ++number) {
    const LightScene scene = scene_number(number, random);
    const LightTreeHandle tree = make_light_tree(device.get(), scene, kWidths[number / 3]);
    for (uint64_t i = 0; i < ray_budget(3000); ++i) {
      const kiwami_light_receiver receiver = receiver_of(scene, number, random);
      const kiwami_light_choice choice = sample(tree, receiver);
      if (choice.light_id == KIWAMI_INVALID_ID) {
        EXPECT_EQ(choice.probability, 0.0f);
        continue;
      }
      const kiwami_light_name name{choice.light_id, choice.instance_id};
      float probability = 0.0f;
      check(kiwami_light_pdf(tree.get(), &receiver, 0, &name, 0, &probability, 0, 1, nullptr));
      ASSERT_EQ(probability, choice.probability) << "scene " << number << ", receiver " << i;
      ASSERT_GT(probability, 0.0f);
      ASSERT_TRUE(choice.random >= 0.0 && choice.random < 1.0) << choice.random;
    }
  }
}

/// The probability that a chi-square variable is greater, by Wilson and Hilferty's approximation.
double chi_square_tail(double statistic, double freedom) {
  const double spread = 2.0 / (9.0 * freedom);
  const double z = (std::cbrt(statistic / freedom) - (1.0 - spread)) / std::sqrt(spread);
  return 0.5 * std::erfc(z / std::sqrt(2.0));
}

TEST(LightSampling, SamplesFollowTheProbabilities) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 622);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const uint64_t samples = std::max<uint64_t>(2000, ray_budget(20000));
  for (uint32_t number = 0; number < 8; ++number) {
    const LightScene scene = scene_number(number, random);
    const std::vector<SeenLight> lights = scene.seen();
    const LightTreeHandle tree = make_light_tree(device.get(), scene, kWidths[number % 4]);
    for (int r = 0; r < 4; ++r) {
      kiwami_light_receiver receiver = receiver_of(scene, number, random);
      const std::vector<float> p = probabilities(tree, lights, receiver);
      std::vector<uint64_t> seen(lights.size(), 0);
      double remapped = 0.0;
      for (uint64_t i = 0; i < samples; ++i) {
        // Stratified: the distribution holds for every sequence of numbers that fills the unit
        // interval, and the statistic would notice one that is skewed all the same.
        receiver.random =
            (static_cast<double>(random.bits()) + static_cast<double>(random.bits()) * 0x1p-32) *
            0x1p-32;
        const kiwami_light_choice choice = sample(tree, receiver);
        if (choice.light_id == KIWAMI_INVALID_ID) break;
        ++seen[index_of(lights, choice)];
        remapped += choice.random;
      }
      double statistic = 0.0, rest_expected = 0.0, rest_seen = 0.0;
      int bins = 0;
      for (size_t i = 0; i < lights.size(); ++i) {
        const double expected = static_cast<double>(p[i]) * static_cast<double>(samples);
        const auto count = static_cast<double>(seen[i]);
        if (p[i] == 0.0f) {
          EXPECT_EQ(seen[i], 0u);
        }
        if (expected < 8.0) {
          rest_expected += expected;
          rest_seen += count;
          continue;
        }
        statistic += (count - expected) * (count - expected) / expected;
        ++bins;
      }
      if (rest_expected >= 8.0) {
        statistic += (rest_seen - rest_expected) * (rest_seen - rest_expected) / rest_expected;
        ++bins;
      }
      if (bins < 2) continue;
      EXPECT_GT(chi_square_tail(statistic, bins - 1.0), 1e-4)
          << "scene " << number << ", receiver " << r << ", seed " << seed();
      // The new random numbers are uniform: their mean is 1/2, to 5 standard errors.
      EXPECT_NEAR(remapped / static_cast<double>(samples), 0.5,
                  5.0 * std::sqrt(1.0 / 12.0 / static_cast<double>(samples)));
    }
  }
}

TEST(LightSampling, EstimatesOfAllLightsAreUnbiased) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 623);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  constexpr int kSamples = 64;
  double deviations = 0.0;
  uint64_t receivers = 0, outliers = 0;
  for (uint32_t number = 0; number < 8; ++number) {
    const LightScene scene = scene_number(number, random);
    const std::vector<SeenLight> lights = scene.seen();
    const LightTreeHandle tree = make_light_tree(device.get(), scene, kWidths[number % 4]);
    for (uint64_t i = 0; i < ray_budget(1250); ++i) {
      kiwami_light_receiver receiver = receiver_of(scene, number, random);
      const std::vector<float> p = probabilities(tree, lights, receiver);
      std::vector<double> f(lights.size());
      double sum = 0.0, square = 0.0;
      for (size_t light = 0; light < lights.size(); ++light) {
        f[light] = contribution(lights[light], receiver);
        sum += f[light];
        if (p[light] > 0.0f) square += f[light] * f[light] / static_cast<double>(p[light]);
      }
      const double variance = (square - sum * sum) / kSamples;
      if (!(variance > 1e-9 * sum * sum)) continue;
      double mean = 0.0;
      for (int k = 0; k < kSamples; ++k) {
        receiver.random = (static_cast<double>(random.bits()) + 0.5) * 0x1p-32;
        const kiwami_light_choice choice = sample(tree, receiver);
        mean += f[index_of(lights, choice)] / static_cast<double>(choice.probability) / kSamples;
      }
      const double deviation = (mean - sum) / std::sqrt(variance);
      deviations += deviation;
      ++receivers;
      if (std::fabs(deviation) > 3.0) ++outliers;
    }
  }
  ASSERT_GT(receivers, 0u);
  // Of all receivers together, within 3 standard errors; alone, not more beyond 3 than the long
  // tails of means of 64 samples have.
  EXPECT_LT(std::fabs(deviations), 3.0 * std::sqrt(static_cast<double>(receivers))) << receivers;
  EXPECT_LT(static_cast<double>(outliers), 0.02 * static_cast<double>(receivers) + 3.0);
}

TEST(LightSampling, EveryIsaChoosesTheSameToTheBit) {
  RecordProperty("seed", std::to_string(seed()));
  for (uint32_t number = 0; number < 12; ++number) {
    const uint32_t width = kWidths[number / 3];
    std::vector<kiwami_light_choice> expected;
    std::vector<float> expected_pdf;
    for (const uint32_t isa : available_isas()) {
      Random random(seed(), 624 + number);
      const LightScene scene = scene_number(number, random);
      const DeviceHandle device = make_device(isa, number % 2 + 1);
      const LightTreeHandle tree = make_light_tree(device.get(), scene, width);
      std::vector<kiwami_light_receiver> receivers(ray_budget(5000));
      for (auto& receiver : receivers) receiver = receiver_of(scene, number, random);
      std::vector<kiwami_light_choice> choices(receivers.size());
      check(kiwami_light_sample(tree.get(), receivers.data(), 0, choices.data(), 0,
                                receivers.size(), nullptr));
      // Any light's probability, not only the chosen one's.
      const std::vector<SeenLight> lights = scene.seen();
      std::vector<kiwami_light_name> names(receivers.size());
      for (auto& name : names) {
        name = lights[random.below(static_cast<uint32_t>(lights.size()))].name;
      }
      std::vector<float> pdf(receivers.size());
      check(kiwami_light_pdf(tree.get(), receivers.data(), 0, names.data(), 0, pdf.data(), 0,
                             receivers.size(), nullptr));
      if (expected.empty()) {
        expected = choices;
        expected_pdf = pdf;
      }
      EXPECT_EQ(std::memcmp(choices.data(), expected.data(),
                            choices.size() * sizeof(kiwami_light_choice)),
                0)
          << "scene " << number << ", ISA " << kiwami_isa_name(isa) << ", width " << width;
      EXPECT_EQ(std::memcmp(pdf.data(), expected_pdf.data(), pdf.size() * sizeof(float)), 0);
    }
  }
}

TEST(LightSampling, BadReceiversGetNoLight) {
  Random random(seed(), 640);
  const LightScene scene = scene_number(0, random);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
  const float bad[] = {std::nanf(""), INFINITY, -INFINITY, 0x1p61f};
  for (const float value : bad) {
    for (int field = 0; field < 9; ++field) {
      if (value == 0x1p61f && field >= 3 && field < 6) continue;  // a long normal is a normal
      kiwami_light_receiver receiver{};
      receiver.link_mask = ~uint64_t{0};
      receiver.random = 0.5;
      float* const fields[] = {receiver.position, receiver.normal, receiver.segment};
      fields[field / 3][field % 3] = value;
      EXPECT_EQ(sample(tree, receiver).light_id, KIWAMI_INVALID_ID) << value << " " << field;
      const kiwami_light_name name{0, KIWAMI_INVALID_ID};
      float probability = 1.0f;
      check(kiwami_light_pdf(tree.get(), &receiver, 0, &name, 0, &probability, 0, 1, nullptr));
      EXPECT_EQ(probability, 0.0f);
    }
  }
  // Random numbers out of range count as the nearest one in range.
  kiwami_light_receiver receiver{};
  receiver.link_mask = ~uint64_t{0};
  const auto choice_with = [&](double number) {
    receiver.random = number;
    return sample(tree, receiver);
  };
  EXPECT_EQ(choice_with(std::nan("")).light_id, choice_with(0.0).light_id);
  EXPECT_EQ(choice_with(-1.0).light_id, choice_with(0.0).light_id);
  EXPECT_EQ(choice_with(2.0).light_id, choice_with(1.0 - 0x1p-53).light_id);
  EXPECT_LT(choice_with(1.0).random, 1.0);
}

TEST(LightSampling, NamesOfNoLightHaveProbabilityZero) {
  Random random(seed(), 641);
  const LightScene scene = scene_number(0, random);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
  kiwami_light_receiver receiver{};
  receiver.link_mask = ~uint64_t{0};
  for (const kiwami_light_name name :
       {kiwami_light_name{KIWAMI_INVALID_ID, KIWAMI_INVALID_ID},
        kiwami_light_name{static_cast<uint32_t>(scene.lights.size()), KIWAMI_INVALID_ID},
        kiwami_light_name{0, 3}, kiwami_light_name{1000, 0}}) {
    float probability = 1.0f;
    check(kiwami_light_pdf(tree.get(), &receiver, 0, &name, 0, &probability, 0, 1, nullptr));
    EXPECT_EQ(probability, 0.0f);
  }
}

}  // namespace
}  // namespace kiwami_tests
