// SPDX-License-Identifier: Apache-2.0
// The methods beside the plain descent: by power alone, and adaptive splitting.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "lights/light_scene.h"
#include "support/environment.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

struct Method {
  const char* name;
  uint32_t method;
  uint32_t max_choices;
  float threshold;
  uint32_t lobe = KIWAMI_LIGHT_LOBE_COSINE;
  uint32_t order = KIWAMI_LIGHT_ORDER_XOR;
  float roughness = 1.0f;

  bool is_roulette() const {
    return method == KIWAMI_LIGHT_METHOD_CULLING || method == KIWAMI_LIGHT_METHOD_ROULETTE ||
           method == KIWAMI_LIGHT_METHOD_LAZY_ROULETTE;
  }
  /// The lobes of glossy receivers: one for all.
  kiwami_light_lobe glossy_lobe() const { return {{1.0f, 2.0f, -0.5f}, roughness}; }
  std::vector<kiwami_light_lobe> glossy_lobes(size_t count) const {
    return std::vector<kiwami_light_lobe>(count, glossy_lobe());
  }

  kiwami_light_query query(const std::vector<kiwami_light_lobe>& lobes) const {
    kiwami_light_query query;
    check(kiwami_light_query_init(&query, sizeof query));
    query.method = method;
    query.max_choices = max_choices;
    query.threshold = threshold;
    query.lobe = lobe;
    query.order = order;
    query.lobes = lobes.data();
    return query;
  }
};

void PrintTo(const Method& method, std::ostream* stream) { *stream << method.name; }

const Method kMethods[] = {
    {"power", KIWAMI_LIGHT_METHOD_POWER, 1, 0.5f},
    {"splitting_1", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 1, 1.0f},
    {"splitting_2", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 2, 1.0f},
    {"splitting_8", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 8, 0.6f},
    {"splitting_64", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 64, 0.9f},
    {"lightcuts_1", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 1, 0.5f},
    {"lightcuts_2", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 2, 0.5f},
    {"lightcuts_10", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 10, 0.5f},
    {"lazy_roulette_64", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 64, 0.5f},
    {"lazy_roulette_4", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 4, 0.5f},
    {"lazy_scrambled_64", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 64, 0.5f, KIWAMI_LIGHT_LOBE_COSINE,
     KIWAMI_LIGHT_ORDER_SCRAMBLED},
    {"culling_64", KIWAMI_LIGHT_METHOD_CULLING, 64, 0.5f},
    {"culling_4", KIWAMI_LIGHT_METHOD_CULLING, 4, 0.5f},
    {"roulette_64", KIWAMI_LIGHT_METHOD_ROULETTE, 64, 0.5f},
    {"roulette_4", KIWAMI_LIGHT_METHOD_ROULETTE, 4, 0.5f},
    {"roulette_sphere_64", KIWAMI_LIGHT_METHOD_ROULETTE, 64, 0.5f,
     KIWAMI_LIGHT_LOBE_TANGENT_SPHERE},
    {"roulette_glossy_64", KIWAMI_LIGHT_METHOD_ROULETTE, 64, 0.5f, KIWAMI_LIGHT_LOBE_GLOSSY,
     KIWAMI_LIGHT_ORDER_XOR, 0.3f},
    {"tree_glossy", KIWAMI_LIGHT_METHOD_TREE, 1, 0.5f, KIWAMI_LIGHT_LOBE_GLOSSY,
     KIWAMI_LIGHT_ORDER_XOR, 0.2f},
    {"splitting_glossy_8", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 8, 0.6f, KIWAMI_LIGHT_LOBE_GLOSSY,
     KIWAMI_LIGHT_ORDER_XOR, 0.05f},
    {"lightcuts_glossy_10", KIWAMI_LIGHT_METHOD_LIGHTCUTS, 10, 0.5f, KIWAMI_LIGHT_LOBE_GLOSSY,
     KIWAMI_LIGHT_ORDER_XOR, 0.2f},
    {"lazy_glossy_64", KIWAMI_LIGHT_METHOD_LAZY_ROULETTE, 64, 0.5f, KIWAMI_LIGHT_LOBE_GLOSSY,
     KIWAMI_LIGHT_ORDER_XOR, 0.05f},
};

std::vector<kiwami_light_choice> sample(const LightTreeHandle& tree, const Method& method,
                                        const std::vector<kiwami_light_receiver>& receivers) {
  std::vector<kiwami_light_choice> choices(receivers.size() * method.max_choices);
  const std::vector<kiwami_light_lobe> lobes = method.glossy_lobes(receivers.size());
  const kiwami_light_query query = method.query(lobes);
  check(kiwami_light_sample(tree.get(), receivers.data(), 0, choices.data(), 0, receivers.size(),
                            &query));
  return choices;
}

std::vector<float> probabilities(const LightTreeHandle& tree, const Method& method,
                                 const std::vector<SeenLight>& lights,
                                 const kiwami_light_receiver& receiver) {
  const std::vector<kiwami_light_receiver> receivers(lights.size(), receiver);
  std::vector<float> result(lights.size());
  const std::vector<kiwami_light_lobe> lobes = method.glossy_lobes(receivers.size());
  const kiwami_light_query query = method.query(lobes);
  check(kiwami_light_pdf(tree.get(), receivers.data(), 0, &lights[0].name, sizeof(SeenLight),
                         result.data(), 0, lights.size(), &query));
  return result;
}

size_t index_of(const std::vector<SeenLight>& lights, const kiwami_light_choice& choice) {
  for (size_t i = 0; i < lights.size(); ++i) {
    if (lights[i].name.light_id == choice.light_id &&
        lights[i].name.instance_id == choice.instance_id) {
      return i;
    }
  }
  ADD_FAILURE() << "no light " << choice.light_id;
  return 0;
}

LightScene scene_number(uint32_t number, Random& random) {
  LightSceneOptions options;
  options.light_count = 40;
  options.group_count = number % 2 == 0 ? 2 : 0;
  options.lights_per_group = 10;
  options.distant_count = number % 3 == 0 ? 3 : 0;
  options.has_link_masks = number % 4 == 1;
  return random_light_scene(options, random);
}

class LightMethods : public testing::TestWithParam<Method> {};

TEST_P(LightMethods, NoContributingLightIsLeftOutAndPdfIsThatOfTheSample) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 650);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  for (uint32_t number = 0; number < 8; ++number) {
    const LightScene scene = scene_number(number, random);
    const std::vector<SeenLight> lights = scene.seen();
    const uint32_t widths[] = {2, 4, 8, 16};
    const LightTreeHandle tree = make_light_tree(device.get(), scene, widths[number % 4]);
    for (uint64_t i = 0; i < ray_budget(100); ++i) {
      const kiwami_light_receiver receiver = random_receiver(scene, random);
      const std::vector<float> p = probabilities(tree, GetParam(), lights, receiver);
      for (size_t light = 0; light < lights.size(); ++light) {
        ASSERT_LE(p[light], 1.0f);
        if (p[light] > 0.0f) continue;
        ASSERT_EQ(contribution(lights[light], receiver), 0.0)
            << "light " << light << ", scene " << number << ", seed " << seed();
      }
      bool has_ended = false;
      std::vector<bool> is_chosen(lights.size(), false);
      const std::vector<kiwami_light_choice> choices = sample(tree, GetParam(), {receiver});
      for (const kiwami_light_choice& choice : choices) {
        has_ended = has_ended || choice.light_id == KIWAMI_INVALID_ID;
        if (has_ended) {
          EXPECT_EQ(choice.light_id, KIWAMI_INVALID_ID) << "choices stand first";
          continue;
        }
        const size_t light = index_of(lights, choice);
        // Of what the roulette accepts and has no room for, the rest is less likely to stay.
        if (GetParam().is_roulette()) {
          ASSERT_LE(choice.probability, p[light]);
          if (choices.back().light_id != KIWAMI_INVALID_ID) continue;
        }
        ASSERT_EQ(choice.probability, p[light]) << "scene " << number << ", receiver " << i;
        ASSERT_TRUE(choice.random >= 0.0 && choice.random < 1.0);
        ASSERT_FALSE(is_chosen[light]) << "twice";
        is_chosen[light] = true;
      }
    }
  }
}

TEST_P(LightMethods, ChoicesFollowTheProbabilities) {
  if (GetParam().is_roulette() && GetParam().max_choices < 64) {
    GTEST_SKIP() << "with little room, not all that are accepted are chosen";
  }
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 651);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const uint64_t samples = std::max<uint64_t>(1000, ray_budget(8000));
  double square = 0.0;
  int count = 0;
  for (uint32_t number = 0; number < 4; ++number) {
    const LightScene scene = scene_number(number, random);
    const std::vector<SeenLight> lights = scene.seen();
    const LightTreeHandle tree = make_light_tree(device.get(), scene, number % 2 == 0 ? 8 : 4);
    const kiwami_light_receiver receiver = random_receiver(scene, random);
    const std::vector<float> p = probabilities(tree, GetParam(), lights, receiver);
    std::vector<kiwami_light_receiver> receivers(samples, receiver);
    for (auto& each : receivers) {
      each.random =
          (static_cast<double>(random.bits()) + static_cast<double>(random.bits()) * 0x1p-32) *
          0x1p-32;
    }
    std::vector<double> seen(lights.size(), 0.0);
    for (const kiwami_light_choice& choice : sample(tree, GetParam(), receivers)) {
      if (choice.light_id != KIWAMI_INVALID_ID) seen[index_of(lights, choice)] += 1.0;
    }
    // Each light is there or not: a binomial number of times.
    for (size_t i = 0; i < lights.size(); ++i) {
      const auto n = static_cast<double>(samples);
      const double probability = static_cast<double>(p[i]), expected = n * probability;
      if (p[i] == 0.0f || p[i] == 1.0f) {
        EXPECT_EQ(seen[i], expected);
      } else if (expected > 8.0 && n - expected > 8.0) {
        const double z = (seen[i] - expected) / std::sqrt(expected * (1.0 - probability));
        EXPECT_LT(std::fabs(z), 5.0) << "light " << i << ", scene " << number;
        square += z * z;
        ++count;
      }
    }
  }
  // Lights of one branch exclude each other, so their squares are not independent; but the mean
  // is 1.
  if (count > 20) {
    EXPECT_LT(square / count, 1.6);
  }
}

/// The variance of an estimate at most, from contributions and probabilities alone. An empirical one
/// would not do: where a light that contributes much is chosen once in a million times, the samples
/// of a test do not know of it, and their mean is far below what is right by their own measure.
double variance_bound(const Method& method, const std::vector<double>& f,
                      const std::vector<float>& p) {
  double sum = 0.0, sum_of_roots = 0.0, of_kept = 0.0, accepted = 0.0;
  for (const float each : p) accepted += static_cast<double>(each);
  const bool is_lazy = method.method == KIWAMI_LIGHT_METHOD_LAZY_ROULETTE;
  for (size_t i = 0; i < f.size(); ++i) {
    const double probability = static_cast<double>(p[i]);
    if (!(probability > 0.0)) continue;
    const double variance = f[i] * f[i] * (1.0 / probability - 1.0);
    sum += variance;
    sum_of_roots += std::sqrt(variance);
    // Of a lights that were accepted, m are kept, each weighed by a / m: given the lights, that adds
    // a / m times the sum of the squares of f / p at most. Where this one is accepted, a is 1 and
    // the others' probabilities on average, or, of numbers that depend on each other, all.
    const double count = is_lazy ? static_cast<double>(f.size()) : 1.0 + accepted - probability;
    of_kept += f[i] * f[i] / probability * count;
  }
  if (!method.is_roulette()) {
    // Lights of one branch exclude each other and branches are independent: no more than of lights
    // that are chosen or not independently.
    return sum;
  }
  // One may be a distant light's.
  const uint32_t room = method.max_choices - 1;
  const double of_choice = f.size() > room ? of_kept / room : 0.0;
  // Of numbers that depend on each other, no more than if all rose and fell together.
  return (is_lazy ? sum_of_roots * sum_of_roots : sum) + of_choice;
}

TEST_P(LightMethods, EstimatesAreUnbiased) {
  RecordProperty("seed", std::to_string(seed()));
  Random random(seed(), 652);
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  constexpr size_t kSamples = 16;
  double deviations = 0.0;
  int count = 0;
  // 10,000 receivers in the long form (scripts/test-lights). Where there are few, one rare choice is
  // more than three standard errors.
  const uint64_t receiver_count = std::max<uint64_t>(100, ray_budget(250));
  for (uint32_t number = 0; number < 4; ++number) {
    const LightScene scene = scene_number(number, random);
    const std::vector<SeenLight> lights = scene.seen();
    const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
    for (uint64_t r = 0; r < receiver_count; ++r) {
      const kiwami_light_receiver receiver = random_receiver(scene, random);
      const std::vector<float> p = probabilities(tree, GetParam(), lights, receiver);
      double expected = 0.0;
      std::vector<double> f(lights.size());
      for (size_t i = 0; i < lights.size(); ++i)
        expected += f[i] = contribution(lights[i], receiver);
      std::vector<kiwami_light_receiver> receivers(kSamples, receiver);
      for (auto& each : receivers) each.random = (random.bits() + 0.5) * 0x1p-32;
      const std::vector<kiwami_light_choice> choices = sample(tree, GetParam(), receivers);
      double mean = 0.0;
      for (size_t i = 0; i < choices.size(); ++i) {
        const kiwami_light_choice& choice = choices[i];
        if (choice.light_id == KIWAMI_INVALID_ID) continue;
        mean += f[index_of(lights, choice)] / static_cast<double>(choice.probability) / kSamples;
      }
      const double variance = variance_bound(GetParam(), f, p);
      if (!(variance > 1e-9 * expected * expected)) {
        EXPECT_NEAR(mean, expected, 1e-4 * expected);
        continue;
      }
      deviations += (mean - expected) / std::sqrt(variance / kSamples);
      ++count;
    }
  }
  ASSERT_GT(count, 0);
  // All receivers together, within 3 standard errors.
  EXPECT_LT(std::fabs(deviations), 3.0 * std::sqrt(static_cast<double>(count))) << count;
  RecordProperty("deviation", std::to_string(deviations / std::sqrt(count)));
}

TEST_P(LightMethods, EveryIsaChoosesTheSame) {
  std::vector<kiwami_light_choice> expected;
  for (const uint32_t width : {4u, 8u, 16u}) {
    expected.clear();
    for (const uint32_t isa : available_isas()) {
      Random random(seed(), 653);
      const LightScene scene = scene_number(0, random);
      const DeviceHandle device = make_device(isa, 2);
      const LightTreeHandle tree = make_light_tree(device.get(), scene, width);
      std::vector<kiwami_light_receiver> receivers(ray_budget(2000));
      for (auto& receiver : receivers) receiver = random_receiver(scene, random);
      const std::vector<kiwami_light_choice> choices = sample(tree, GetParam(), receivers);
      if (expected.empty()) expected = choices;
      EXPECT_EQ(std::memcmp(choices.data(), expected.data(),
                            choices.size() * sizeof(kiwami_light_choice)),
                0)
          << kiwami_isa_name(isa) << ", width " << width;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, LightMethods, testing::ValuesIn(kMethods),
                         [](const auto& each) { return std::string(each.param.name); });

TEST(LightSplitting, ThresholdSaysHowMuchIsSplit) {
  Random random(seed(), 654);
  LightSceneOptions options;
  options.light_count = 50;
  const LightScene scene = random_light_scene(options, random);
  const std::vector<SeenLight> lights = scene.seen();
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const LightTreeHandle tree = make_light_tree(device.get(), scene, 8);
  kiwami_light_receiver receiver{};
  receiver.link_mask = ~uint64_t{0};
  receiver.position[0] = 3.0f;
  receiver.random = 0.37;
  const auto count_at = [&](float threshold) {
    const Method method{"", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 64, threshold};
    int count = 0;
    for (const auto& choice : sample(tree, method, {receiver})) {
      count += choice.light_id != KIWAMI_INVALID_ID ? 1 : 0;
    }
    return count;
  };
  // 0: the plain descent. 1: every light that can contribute, for certain.
  EXPECT_EQ(count_at(0.0f), 1);
  kiwami_light_choice plain;
  check(kiwami_light_sample(tree.get(), &receiver, 0, &plain, 0, 1, nullptr));
  const Method never{"", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 64, 0.0f};
  EXPECT_EQ(std::memcmp(&plain, sample(tree, never, {receiver}).data(), sizeof plain), 0);
  const Method always{"", KIWAMI_LIGHT_METHOD_TREE_SPLITTING, 64, 1.0f};
  const std::vector<float> p = probabilities(tree, always, lights, receiver);
  for (size_t i = 0; i < lights.size(); ++i) {
    if (contribution(lights[i], receiver) > 0.0) {
      EXPECT_EQ(p[i], 1.0f) << i;
    }
  }
  int last = 1;
  for (const float threshold : {0.3f, 0.5f, 0.7f, 0.8f, 0.9f, 1.0f}) {
    const int count = count_at(threshold);
    EXPECT_GE(count, last) << threshold;
    last = count;
  }
  EXPECT_GT(last, 10);
}

}  // namespace
}  // namespace kiwami_tests
