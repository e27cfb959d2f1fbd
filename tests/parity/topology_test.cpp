// SPDX-License-Identifier: Apache-2.0
// What closed meshes promise, by the kernels on the trees that the library builds.
#include <gtest/gtest.h>

#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/feature_rays.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/report.h"
#include "support/silhouette.h"

namespace kiwami_tests {
namespace {

constexpr size_t kBatch = 50000;

/// One committed scene per width, merged, of one closed mesh.
class Topology : public testing::TestWithParam<ClosedMesh> {
 protected:
  void SetUp() override {
    device_ = make_device(KIWAMI_ISA_SCALAR, 1);
    for (const NamedKernels& kernels : all_kernels()) {
      auto& scene = scenes_[kernels.width / 8];
      if (!scene) scene = make_scene(device_.get(), scene_of(GetParam()), {kernels.width});
    }
    rays_left_ = ray_budget(140000) / 7;
  }

  const kiwami::SceneView& view_for(const NamedKernels& kernels) const {
    return view_of(scenes_[kernels.width / 8].get());
  }

  /// The next rays of the budget; empty at its end.
  template <typename MakeRay>
  std::vector<kiwami_ray> next_batch(MakeRay make_ray) {
    std::vector<kiwami_ray> rays(std::min<uint64_t>(rays_left_, kBatch));
    rays_left_ -= rays.size();
    for (size_t i = 0; i < rays.size(); ++i) rays[i] = make_ray(i);
    return rays;
  }

  uint64_t rays_left_ = 0;

 private:
  DeviceHandle device_;
  SceneHandle scenes_[3];
};

TEST_P(Topology, IsCrossedAnEvenNumberOfTimesByAllKernelsAndThePlainLoop) {
  const Scene scene = scene_of(GetParam());
  const PlainOracle oracle(scene);
  FeatureRayGenerator generator(GetParam(), Random(seed(), 11));
  const std::vector<NamedKernels> kernels = all_kernels();
  uint64_t crossings = 0;
  const auto make_ray = [&](size_t i) {
    return i % 4 == 3 ? generator.line() : generator.outside_segment();
  };
  for (auto rays = next_batch(make_ray); !rays.empty(); rays = next_batch(make_ray)) {
    std::vector<uint32_t> expected(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) {
      expected[i] = oracle.all_hits(rays[i]);
      crossings += expected[i];
      ASSERT_EQ(expected[i] % 2, 0u) << "KIWAMI_SEED=" << seed() << ": " << describe(rays[i]);
    }
    for (const NamedKernels& named : kernels) {
      const auto counts = run_all_hits(named.kernels.all_hits, view_for(named), rays);
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_EQ(counts[i], expected[i])
            << named.name << ", KIWAMI_SEED=" << seed() << ": " << describe(rays[i]);
      }
    }
  }
  EXPECT_GT(crossings, 0u);
}

TEST_P(Topology, IsHitFromInsideByAllKernels) {
  FeatureRayGenerator generator(GetParam(), Random(seed(), 12));
  const std::vector<NamedKernels> kernels = all_kernels();
  const auto make_ray = [&](size_t) { return generator.inside_ray(); };
  for (auto rays = next_batch(make_ray); !rays.empty(); rays = next_batch(make_ray)) {
    for (const NamedKernels& named : kernels) {
      const auto hits = run_closest_hit(named.kernels.closest_hit, view_for(named), rays);
      const auto any = run_any_hit(named.kernels.any_hit, view_for(named), rays);
      for (size_t i = 0; i < rays.size(); ++i) {
        ASSERT_TRUE(hits[i].primitive_id != KIWAMI_INVALID_ID && any[i] == 1)
            << named.name << ", KIWAMI_SEED=" << seed() << ": " << describe(rays[i]);
      }
    }
  }
}

TEST_P(Topology, IsMissedOnlyAtItsSilhouette) {
  FeatureRayGenerator generator(GetParam(), Random(seed(), 13));
  const SilhouetteJudge judge(GetParam().mesh);
  const std::vector<NamedKernels> kernels = all_kernels();
  rays_left_ /= 4;
  uint64_t misses = 0, hits_in_double = 0;
  const auto make_ray = [&](size_t) { return generator.outside_segment(); };
  for (auto rays = next_batch(make_ray); !rays.empty(); rays = next_batch(make_ray)) {
    const NamedKernels& named = kernels[rays_left_ / kBatch % kernels.size()];
    const auto any = run_any_hit(named.kernels.any_hit, view_for(named), rays);
    for (size_t i = 0; i < rays.size(); ++i) {
      if (any[i]) continue;
      ++misses;
      const SilhouetteJudge::Verdict verdict = judge.judge(rays[i]);
      hits_in_double += verdict.is_hit;
      ASSERT_FALSE(verdict.is_hit && verdict.distance > verdict.margin)
          << named.name << ", KIWAMI_SEED=" << seed() << ": hit in double, " << verdict.distance
          << " from the silhouette, margin " << verdict.margin << ": " << describe(rays[i]);
    }
  }
  std::printf("%s: %llu misses, %llu of them hits in double at the silhouette\n",
              GetParam().name.c_str(), static_cast<unsigned long long>(misses),
              static_cast<unsigned long long>(hits_in_double));
}

/// Were all rays missed, the double-precision judge would say so.
TEST_P(Topology, WouldBeCaughtIfRaysWereMissed) {
  FeatureRayGenerator generator(GetParam(), Random(seed(), 14));
  const SilhouetteJudge judge(GetParam().mesh);
  int caught = 0;
  for (int i = 0; i < 200; ++i) {
    const SilhouetteJudge::Verdict verdict = judge.judge(generator.outside_segment());
    caught += verdict.is_hit && verdict.distance > verdict.margin;
  }
  EXPECT_GT(caught, 20);
}

INSTANTIATE_TEST_SUITE_P(All, Topology, testing::ValuesIn(closed_meshes()), [](const auto& test) {
  std::string name = test.param.name;
  for (char& c : name) c = std::isalnum(static_cast<unsigned char>(c)) ? c : '_';
  return name;
});

}  // namespace
}  // namespace kiwami_tests
