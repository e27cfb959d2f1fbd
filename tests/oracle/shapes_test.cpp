// SPDX-License-Identifier: Apache-2.0
// Spheres, discs and round curves against Embree's own. Embree computes in single precision: its
// distances are off by a part of the ray's length or of the shape, and rays that only just meet a
// shape may miss it. Each exception is counted.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>

#include "measure/camera.h"
#include "measure/shape_scene.h"
#include "support/environment.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

using kiwami::tools::ShapeCloud;

/// Rays from around a cloud to points about its shapes.
std::vector<kiwami_ray> rays_at(const ShapeCloud& cloud, size_t count) {
  Random random(seed(), 51);
  std::vector<kiwami_ray> rays;
  const auto points = static_cast<uint32_t>(cloud.points.size() / 4);
  while (rays.size() < count) {
    const float* at = cloud.points.data() + size_t{4} * random.below(points);
    const auto jitter = [&] { return 1.5f * at[3] * random.symmetric(); };
    const kiwami::tools::Vec3 origin = {4.0f * random.symmetric(), 4.0f * random.symmetric(),
                                        4.0f * random.symmetric()};
    // Embree's curves are not hit from inside.
    if (length(origin) < 2.5f) continue;
    const kiwami::tools::Vec3 target = {at[0] + jitter(), at[1] + jitter(), at[2] + jitter()};
    rays.push_back(kiwami::tools::make_ray(origin, target - origin, 0.0f, INFINITY));
  }
  return rays;
}

class EmbreeShapeOracle : public testing::TestWithParam<std::string> {};

TEST_P(EmbreeShapeOracle, AgreesWithinSinglePrecision) {
  const ShapeCloud cloud = kiwami::tools::make_cloud(GetParam(), 20000);
  const kiwami::tools::Device device(KIWAMI_ISA_AUTO, 1);
  const kiwami::tools::ShapeScene own(device, cloud);
  const auto embree = kiwami::tools::EmbreeShapes::create(cloud, device.info().isa);
  ASSERT_TRUE(embree);
  const std::vector<kiwami_ray> rays = rays_at(cloud, ray_budget(60000));
  std::vector<kiwami_hit> hits(rays.size()), reference(rays.size());
  own.closest_hits(rays, hits);
  embree->closest_hits(rays, reference);
  size_t hit_count = 0, other_distance = 0, missed_there = 0, missed_here = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const bool is_hit = hits[i].primitive_id != KIWAMI_INVALID_ID;
    const bool is_hit_there = reference[i].primitive_id != KIWAMI_INVALID_ID;
    hit_count += is_hit;
    if (is_hit && is_hit_there) {
      other_distance += std::fabs(hits[i].t - reference[i].t) > 1e-3f;
    } else {
      missed_there += is_hit;
      missed_here += is_hit_there;
    }
  }
  std::printf(
      "%s, KIWAMI_SEED=%llu: of %zu rays %zu hit; %zu at another distance, %zu miss in "
      "Embree alone, %zu here alone\n",
      GetParam().c_str(), static_cast<unsigned long long>(seed()), rays.size(), hit_count,
      other_distance, missed_there, missed_here);
  EXPECT_GT(hit_count, rays.size() / 4);
  EXPECT_LE(other_distance + missed_there + missed_here, 1 + rays.size() / 200);
}

INSTANTIATE_TEST_SUITE_P(All, EmbreeShapeOracle, testing::ValuesIn(kiwami::tools::cloud_names()),
                         [](const auto& test) { return test.param; });

}  // namespace
}  // namespace kiwami_tests
