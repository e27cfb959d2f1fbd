// SPDX-License-Identifier: Apache-2.0
// Closest hits against Embree with its robust scene flag, on every public scene. Double precision
// decides wherever the two disagree; every kind of exception is counted and named.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>

#include "measure/double_judge.h"
#include "measure/tracer.h"
#include "scene/scene_file.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/public_scene.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

using kiwami::tools::Agreement;

float greatest_of(float x, float y, float z) {
  return std::max({std::fabs(x), std::fabs(y), std::fabs(z)});
}

/// A ray of the generator as Embree takes it: the whole half line, no masks, no flags, numbers at
/// which single precision neither overflows nor underflows. False for a ray that cannot be.
bool make_plain(kiwami_ray& ray) {
  const float origin = greatest_of(ray.origin_x, ray.origin_y, ray.origin_z);
  const float length = greatest_of(ray.direction_x, ray.direction_y, ray.direction_z);
  const float sum = ray.origin_x + ray.origin_y + ray.origin_z + ray.direction_x + ray.direction_y +
                    ray.direction_z;
  if (!std::isfinite(sum) || !(origin < 0x1p40f && length > 0x1p-20f && length < 0x1p20f)) {
    return false;
  }
  ray.tmin = 0.0f;
  ray.tmax = std::numeric_limits<float>::infinity();
  ray.mask = ~0u;
  ray.flags = 0;
  return true;
}

using Tally = std::array<uint64_t, kiwami::tools::kAgreementCount>;

bool is_wrong(const kiwami::tools::SceneFile& file, const kiwami_ray& ray, const kiwami_hit& own,
              const kiwami_hit& reference) {
  return kiwami::tools::compare_hits(file, ray, own, reference) == Agreement::kWrong;
}

class Embree : public testing::TestWithParam<std::filesystem::path> {
 protected:
  void SetUp() override {
    if (GetParam().empty()) GTEST_SKIP() << "SKIPPED: no public scenes; set KIWAMI_SCENES";
    file_ = kiwami::tools::flatten(kiwami::tools::load_scene(GetParam()));
    const Scene scene = load_public_scene(GetParam());
    if (scene.triangle_count() > 5 * public_scene_limit()) {
      GTEST_SKIP() << "SKIPPED: " << scene.triangle_count()
                   << " triangles; KIWAMI_TEST_SCENE_TRIANGLES changes the limit";
    }
    RayGenerator generator(scene, Random(seed(), 31));
    rays_.reserve(ray_budget(480000) / public_scenes().size() + 1);
    while (rays_.size() < rays_.capacity()) {
      kiwami_ray ray = generator.next();
      if (make_plain(ray)) rays_.push_back(ray);
    }
    const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 0);
    own_ = closest_hits(make_scene(device.get(), scene, {}).get(), rays_);
    reference_.resize(rays_.size());
    kiwami::tools::EmbreeTracer::create(file_, true)->closest_hits(rays_, reference_);
  }

  kiwami::tools::SceneFile file_;
  std::vector<kiwami_ray> rays_;
  std::vector<kiwami_hit> own_, reference_;
};

TEST_P(Embree, AgreesOrDoublePrecisionExplainsIt) {
  Tally tally{};
  for (size_t i = 0; i < rays_.size(); ++i) {
    const Agreement agreement =
        kiwami::tools::compare_hits(file_, rays_[i], own_[i], reference_[i]);
    ++tally[static_cast<size_t>(agreement)];
    EXPECT_NE(agreement, Agreement::kWrong)
        << "KIWAMI_SEED=" << seed() << ": " << describe(rays_[i]) << "\n  own    "
        << describe(own_[i]) << "\n  Embree " << describe(reference_[i]);
  }
  std::printf("%s: %zu rays\n", GetParam().filename().c_str(), rays_.size());
  for (size_t kind = 0; kind < tally.size(); ++kind) {
    if (tally[kind] == 0) continue;
    std::printf("  %10llu  %s\n", static_cast<unsigned long long>(tally[kind]),
                kiwami::tools::agreement_name(static_cast<Agreement>(kind)));
  }
}

/// Hits taken away and distances off by a thousandth do not pass as exceptions.
TEST_P(Embree, CatchesInjectedErrors) {
  uint64_t hits = 0, caught_misses = 0, caught_distances = 0;
  for (size_t i = 0; i < rays_.size() && hits < 1000; ++i) {
    if (own_[i].primitive_id == KIWAMI_INVALID_ID || !(own_[i].t > 0.0f)) continue;
    ++hits;
    kiwami_hit wrong = own_[i];
    wrong.t *= 1.001f;
    caught_distances += is_wrong(file_, rays_[i], wrong, reference_[i]);
    wrong = {};
    wrong.t = std::numeric_limits<float>::infinity();
    wrong.primitive_id = wrong.geometry_id = wrong.instance_id = KIWAMI_INVALID_ID;
    caught_misses += is_wrong(file_, rays_[i], wrong, reference_[i]);
  }
  EXPECT_GT(hits, 0u);
  EXPECT_GT(caught_misses, hits / 10);
  EXPECT_GT(caught_distances, hits / 10);
}

INSTANTIATE_TEST_SUITE_P(All, Embree, testing::ValuesIn(public_scenes_or_none()),
                         [](const auto& test) { return test_name_of(test.param); });

}  // namespace
}  // namespace kiwami_tests
