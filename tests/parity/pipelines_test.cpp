// SPDX-License-Identifier: Apache-2.0
// Every pipeline on random scenes of the kinds that break ray tracers: valid after each stage, and
// the answers those of a plain loop over all triangles, to the bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "parity/all_pipelines.h"
#include "support/adversarial_scenes.h"
#include "support/environment.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

constexpr uint32_t kScenes = 200;
constexpr uint32_t kParts = 4;
constexpr size_t kRays = 24;

struct Expected {
  std::vector<kiwami_ray> rays;
  std::vector<kiwami_hit> hits;
};

Expected expected_of(const Scene& scene, uint32_t index) {
  const PlainOracle oracle(scene);
  RayGenerator generator(scene, Random(seed() + index, 77));
  Expected expected;
  for (size_t i = 0; i < kRays; ++i) {
    expected.rays.push_back(generator.next());
    expected.hits.push_back(oracle.closest_hit(expected.rays.back()));
  }
  return expected;
}

/// What is wrong with the answers of a scene; "" when nothing is.
std::string difference(const kiwami_scene* scene, const Expected& expected) {
  const std::vector<kiwami_hit> hits = closest_hits(scene, expected.rays);
  const std::vector<uint8_t> any = any_hits(scene, expected.rays);
  for (size_t i = 0; i < expected.rays.size(); ++i) {
    const bool is_hit = expected.hits[i].primitive_id != KIWAMI_INVALID_ID;
    if (is_same(hits[i], expected.hits[i]) && (any[i] != 0) == is_hit) continue;
    return describe(expected.rays[i]) + "\n  expected " + describe(expected.hits[i]) +
           "\n  answer " + describe(hits[i]) + " any " + std::to_string(any[i]);
  }
  return "";
}

/// In parts, which run side by side.
class Pipelines : public testing::TestWithParam<uint32_t> {};

TEST_P(Pipelines, GiveTheSameBitsOnRandomScenes) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  std::vector<DeviceHandle> devices;
  for (const uint32_t isa : available_isas()) devices.push_back(make_device(isa, 1));
  const std::vector<Pipeline> pipelines = all_pipelines();
  const auto scenes = static_cast<uint32_t>(case_budget(kScenes / kParts));
  for (uint32_t i = 0; i < scenes; ++i) {
    const uint32_t index = GetParam() * scenes + i;
    const Scene scene = adversarial_scene(index, seed());
    const Expected expected = expected_of(scene, index);
    for (uint32_t p = 0; p < pipelines.size(); ++p) {
      // Each pipeline meets every other choice, in one scene or another.
      const uint32_t number = p + index;
      const auto device = devices[(p + index / 7) % devices.size()].get();
      const BuildOptions options = pipelines[p].options(number, expected.rays);
      const auto what = [&] {
        return pipelines[p].name() + ", width " + std::to_string(options.width) + ", scene " +
               std::to_string(index) + ", KIWAMI_SEED=" + std::to_string(seed());
      };
      SceneHandle made;
      ASSERT_NO_THROW(made = make_scene(device, scene, options)) << what();
      ASSERT_EQ(difference(made.get(), expected), "") << what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, Pipelines, testing::Range(0u, kParts));

TEST(AllPipelines, HoldEveryBuilderAndMeetEveryChoice) {
  const std::vector<Pipeline> pipelines = all_pipelines();
  EXPECT_GE(pipelines.size(), 100u);
  for (const char* name : {"binned_sah", "wide_linear", "wide_top_down", "wide_bottom_up", "trial",
                           "wide_linear + reorder_sato", "wide_top_down + reinsertion",
                           "trial + parallel_reinsertion", "spatial_split + rotation"}) {
    EXPECT_EQ(std::count_if(pipelines.begin(), pipelines.end(),
                            [&](const Pipeline& pipeline) { return pipeline.name() == name; }),
              1)
        << name;
  }
}

}  // namespace
}  // namespace kiwami_tests
