// SPDX-License-Identifier: Apache-2.0
// Real scenes: every ISA, width and thread count, merged or not, against one scalar tree, and that
// against the plain oracle.
#include "support/public_scene.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "parity/all_pipelines.h"
#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

/// Triangles that the plain oracle tests in the short form, of all its rays together.
constexpr uint64_t kOracleTests = 10000000;
/// All pipelines take scenes of so many times fewer triangles.
constexpr uint64_t kPipelineShare = 10;

struct Answers {
  std::vector<kiwami_hit> hits;
  std::vector<uint8_t> any;
};

/// The first ray on which the answers differ; "" when there is none.
std::string difference(const Answers& answers, const Answers& expected,
                       const std::vector<kiwami_ray>& rays) {
  for (size_t i = 0; i < rays.size(); ++i) {
    if (is_same(answers.hits[i], expected.hits[i]) && answers.any[i] == expected.any[i]) continue;
    return "ray " + std::to_string(i) + ": " + describe(rays[i]) + "\n  scalar " +
           describe(expected.hits[i]) + " any " + std::to_string(expected.any[i]) + "\n  answer " +
           describe(answers.hits[i]) + " any " + std::to_string(answers.any[i]);
  }
  return "";
}

class PublicScenes : public testing::TestWithParam<std::filesystem::path> {
 protected:
  void SetUp() override {
    if (GetParam().empty()) GTEST_SKIP() << "SKIPPED: no public scenes; set KIWAMI_SCENES";
    scene_ = load_public_scene(GetParam());
    if (scene_.triangle_count() > public_scene_limit()) {
      GTEST_SKIP() << "SKIPPED: " << scene_.triangle_count() << " triangles; the short form takes "
                   << public_scene_limit() << ", KIWAMI_TEST_SCENE_TRIANGLES changes it";
    }
    RayGenerator generator(scene_, Random(seed(), 21));
    rays_.resize(std::max<uint64_t>(1, ray_budget(100000) / public_scenes().size()));
    for (kiwami_ray& ray : rays_) ray = generator.next();
    device_ = make_device(KIWAMI_ISA_SCALAR, 2);
    reference_ = make_scene(device_.get(), scene_, {8, false, 0, true});
    expected_ = {closest_hits(reference_.get(), rays_), any_hits(reference_.get(), rays_)};
  }

  Scene scene_;
  std::vector<kiwami_ray> rays_;
  DeviceHandle device_;
  SceneHandle reference_;
  Answers expected_;
};

TEST_P(PublicScenes, GiveTheSameBitsEverywhere) {
  for (const uint32_t isa : available_isas()) {
    for (const bool merges_leaves : {true, false}) {
      const DeviceHandle device = make_device(isa, merges_leaves ? 2 : 1);
      ASSERT_EQ(info_of(device.get()).isa, isa);
      for (const uint32_t width : {4u, 8u, 16u}) {
        const SceneHandle scene = make_scene(device.get(), scene_, {width, merges_leaves});
        const Answers plain{closest_hits(scene.get(), rays_), any_hits(scene.get(), rays_)};
        const Answers by_fields{closest_hits_by_fields(scene.get(), rays_),
                                any_hits_by_fields(scene.get(), rays_)};
        for (const Answers* answers : {&plain, &by_fields}) {
          const std::string found = difference(*answers, expected_, rays_);
          ASSERT_TRUE(found.empty()) << kiwami_isa_name(isa) << ", width " << width
                                     << (merges_leaves ? ", merged" : ", not merged")
                                     << ", KIWAMI_SEED=" << seed() << ", " << found;
        }
      }
    }
  }
}

TEST_P(PublicScenes, GiveTheSameBitsByEveryPipeline) {
  if (scene_.triangle_count() > public_scene_limit() / kPipelineShare) {
    GTEST_SKIP() << "SKIPPED: " << scene_.triangle_count() << " triangles; the short form takes "
                 << public_scene_limit() / kPipelineShare;
  }
  rays_.resize(std::max<size_t>(1, rays_.size() / 16));
  std::vector<DeviceHandle> devices;
  for (const uint32_t isa : available_isas()) devices.push_back(make_device(isa, 1));
  const std::vector<Pipeline> pipelines = all_pipelines();
  for (uint32_t i = 0; i < pipelines.size(); ++i) {
    const SceneHandle scene =
        make_scene(devices[i % devices.size()].get(), scene_, pipelines[i].options(i, rays_));
    const Answers answers{closest_hits(scene.get(), rays_), any_hits(scene.get(), rays_)};
    const std::string found = difference(answers, expected_, rays_);
    ASSERT_TRUE(found.empty()) << pipelines[i].name() << ", KIWAMI_SEED=" << seed() << ", "
                               << found;
  }
}

TEST_P(PublicScenes, AgreeWithThePlainOracle) {
  const PlainOracle oracle(scene_);
  const uint64_t longest = std::max<uint64_t>(1, kOracleTests / (scene_.triangle_count() + 1));
  const size_t count = std::min<size_t>(rays_.size(), longest);
  for (size_t i = 0; i < count; ++i) {
    const kiwami_hit hit = oracle.closest_hit(rays_[i]);
    ASSERT_TRUE(is_same(hit, expected_.hits[i]))
        << "KIWAMI_SEED=" << seed() << ": " << describe(rays_[i]) << "\n  oracle " << describe(hit)
        << "\n  scalar " << describe(expected_.hits[i]);
    ASSERT_EQ(expected_.any[i] == 1, hit.primitive_id != KIWAMI_INVALID_ID) << describe(rays_[i]);
  }
}

TEST_P(PublicScenes, NeverLeaveTheMarginOfTheirBoxes) {
  rays_.resize(std::min<size_t>(rays_.size(), std::max<size_t>(5000, rays_.size() / 4)));
  for (const uint32_t width : {4u, 8u, 16u}) {
    const SceneHandle scene = make_scene(device_.get(), scene_, {width, true, 1});
    for (const NamedKernels& named : all_kernels()) {
      if (named.width != width) continue;
      kiwami::TraversalCounters counters{};
      const auto& view = view_of(scene.get());
      const auto hits =
          run_counted_closest_hit(named.kernels.closest_hit_counted, view, rays_, counters);
      const auto any = run_counted_any_hit(named.kernels.any_hit_counted, view, rays_, counters);
      EXPECT_EQ(counters.margin_violations, 0u) << named.name << ", KIWAMI_SEED=" << seed();
      const Answers expected{{expected_.hits.begin(), expected_.hits.begin() + rays_.size()},
                             {expected_.any.begin(), expected_.any.begin() + rays_.size()}};
      EXPECT_EQ(difference({hits, any}, expected, rays_), "") << named.name;
    }
  }
}

TEST_P(PublicScenes, AreCaughtWhenAnAnswerIsOffByOneBit) {
  Answers wrong = expected_;
  ASSERT_EQ(difference(wrong, expected_, rays_), "");
  wrong.hits.back().u = std::nextafter(wrong.hits.back().u, 2.0f);
  EXPECT_NE(difference(wrong, expected_, rays_), "");
}

INSTANTIATE_TEST_SUITE_P(All, PublicScenes, testing::ValuesIn(public_scenes_or_none()),
                         [](const auto& test) { return test_name_of(test.param); });

}  // namespace
}  // namespace kiwami_tests
