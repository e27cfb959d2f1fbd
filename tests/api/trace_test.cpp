// SPDX-License-Identifier: Apache-2.0
// Rays in arrays: strides, counts, masks, culling, closest and any hit.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstring>
#include <limits>
#include <string>

#include "api/api_support.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

class TraceTest : public testing::Test {
 protected:
  TraceTest() { RecordProperty("seed", std::to_string(seed_)); }

  uint8_t any_hit(const Scene& scene, const kiwami_ray& ray) {
    uint8_t occluded = 7;
    EXPECT_EQ(kiwami_any_hit(scene.get(), &ray, 0, &occluded, 0, 1, nullptr), KIWAMI_OK);
    return occluded;
  }

  const uint64_t seed_ = kiwami_tests::seed();
  const Device device_ = make_device();
  const Triangles triangles_ = random_triangles(400, seed_);
  const Scene scene_ = make_scene(device_, make_mesh(device_, triangles_.desc()));
};

TEST_F(TraceTest, NoRaysAreFine) {
  EXPECT_EQ(kiwami_closest_hit(scene_.get(), nullptr, 0, nullptr, 0, 0, nullptr), KIWAMI_OK);
  EXPECT_EQ(kiwami_any_hit(scene_.get(), nullptr, 0, nullptr, 0, 0, nullptr), KIWAMI_OK);
}

TEST_F(TraceTest, AnyHitIsTrueExactlyWhenThereIsAClosestHit) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed_));
  const std::vector<kiwami_ray> rays = random_rays(20000, seed_);
  const std::vector<kiwami_hit> hits = closest_hits(scene_, rays);
  std::vector<uint8_t> occluded(rays.size(), 7);
  ASSERT_EQ(kiwami_any_hit(scene_.get(), rays.data(), 0, occluded.data(), 0, rays.size(), nullptr),
            KIWAMI_OK);
  size_t hit_count = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    ASSERT_EQ(occluded[i], hits[i].primitive_id != KIWAMI_INVALID_ID) << i;
    hit_count += occluded[i];
  }
  EXPECT_GT(hit_count, rays.size() / 20);
  EXPECT_LT(hit_count, rays.size());
}

TEST_F(TraceTest, BatchesOfEverySizeGiveTheAnswersOfSingleRays) {
  const std::vector<kiwami_ray> rays = random_rays(10000, seed_);
  std::vector<kiwami_hit> alone(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    kiwami_closest_hit(scene_.get(), &rays[i], 0, &alone[i], 0, 1, nullptr);
  }
  EXPECT_TRUE(are_equal(closest_hits(scene_, rays), alone));
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.flags = KIWAMI_QUERY_CALLING_THREAD;
  std::vector<kiwami_hit> hits(rays.size());
  ASSERT_EQ(kiwami_closest_hit(scene_.get(), rays.data(), 0, hits.data(), 0, rays.size(), &query),
            KIWAMI_OK);
  EXPECT_TRUE(are_equal(hits, alone));
}

TEST_F(TraceTest, RaysAndHitsMayLieInTheCallersStructsAtAnyAddress) {
  constexpr size_t kStride = sizeof(kiwami_ray) + sizeof(kiwami_hit) + 5;
  const std::vector<kiwami_ray> rays = random_rays(5000, seed_);
  std::vector<unsigned char> bytes(rays.size() * kStride + 1, 0xAB);
  for (size_t i = 0; i < rays.size(); ++i) {
    std::memcpy(&bytes[1 + i * kStride], &rays[i], sizeof rays[i]);
  }
  unsigned char* first = bytes.data() + 1;
  ASSERT_EQ(kiwami_closest_hit(scene_.get(), reinterpret_cast<kiwami_ray*>(first), kStride,
                               reinterpret_cast<kiwami_hit*>(first + sizeof(kiwami_ray)), kStride,
                               rays.size(), nullptr),
            KIWAMI_OK);
  const std::vector<kiwami_hit> expected = closest_hits(scene_, rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    const unsigned char* ray = first + i * kStride;
    ASSERT_EQ(std::memcmp(ray, &rays[i], sizeof rays[i]), 0) << "a ray was changed";
    ASSERT_EQ(std::memcmp(ray + sizeof(kiwami_ray), &expected[i], sizeof expected[i]), 0) << i;
    for (size_t k = kStride - 5; k < kStride; ++k) ASSERT_EQ(ray[k], 0xAB);
  }
}

TEST_F(TraceTest, OcclusionBytesHaveAStride) {
  const std::vector<kiwami_ray> rays = random_rays(100, seed_);
  const std::vector<kiwami_hit> hits = closest_hits(scene_, rays);
  std::vector<uint8_t> occluded(300, 7);
  ASSERT_EQ(kiwami_any_hit(scene_.get(), rays.data(), 0, occluded.data(), 3, 100, nullptr),
            KIWAMI_OK);
  for (size_t i = 0; i < 100; ++i) {
    EXPECT_EQ(occluded[3 * i], hits[i].primitive_id != KIWAMI_INVALID_ID);
    EXPECT_EQ(occluded[3 * i + 1], 7);
    EXPECT_EQ(occluded[3 * i + 2], 7);
  }
}

TEST_F(TraceTest, MasksDecideWhatARayMeets) {
  const Triangles near = square(1), far = square(2);
  kiwami_triangle_mesh_desc near_desc = near.desc(), far_desc = far.desc();
  near_desc.mask = 0x6;
  far_desc.mask = 0x9;
  const Scene scene = make_scene(device_);
  const Geometry near_mesh = make_mesh(device_, near_desc), far_mesh = make_mesh(device_, far_desc);
  kiwami_scene_attach(scene.get(), near_mesh.get(), nullptr);
  kiwami_scene_attach(scene.get(), far_mesh.get(), nullptr);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  kiwami_ray ray = ray_along_z(0.5f, 0.25f);
  const auto t_with = [&](uint32_t mask) {
    ray.mask = mask;
    EXPECT_EQ(any_hit(scene, ray), closest_hit(scene, ray).t < kInfinity);
    return closest_hit(scene, ray).t;
  };
  EXPECT_EQ(t_with(~0u), 1.0f);
  EXPECT_EQ(t_with(0x2), 1.0f);
  EXPECT_EQ(t_with(0x8), 2.0f);
  EXPECT_EQ(t_with(0x10), kInfinity);
  EXPECT_EQ(t_with(0), kInfinity);
}

TEST_F(TraceTest, CullingFlagsIgnoreOneSide) {
  const Triangles triangles = square(1);  // its normals along +z
  const Scene scene = make_scene(device_, make_mesh(device_, triangles.desc()));
  kiwami_ray from_behind = ray_along_z(0.5f, 0.25f);
  kiwami_ray from_front = from_behind;
  from_front.origin_z = 2;
  from_front.direction_z = -1;
  const auto hits = [&](kiwami_ray ray, uint32_t flags) {
    ray.flags = flags;
    EXPECT_EQ(any_hit(scene, ray), closest_hit(scene, ray).t == 1.0f);
    return any_hit(scene, ray) == 1;
  };
  EXPECT_TRUE(hits(from_front, 0));
  EXPECT_TRUE(hits(from_behind, 0));
  EXPECT_TRUE(hits(from_front, KIWAMI_RAY_CULL_BACK_FACES));
  EXPECT_FALSE(hits(from_behind, KIWAMI_RAY_CULL_BACK_FACES));
  EXPECT_FALSE(hits(from_front, KIWAMI_RAY_CULL_FRONT_FACES));
  EXPECT_TRUE(hits(from_behind, KIWAMI_RAY_CULL_FRONT_FACES));
  EXPECT_FALSE(hits(from_front, KIWAMI_RAY_CULL_FRONT_FACES | KIWAMI_RAY_CULL_BACK_FACES));
  EXPECT_FALSE(hits(from_behind, KIWAMI_RAY_CULL_FRONT_FACES | KIWAMI_RAY_CULL_BACK_FACES));
}

TEST_F(TraceTest, TheBoundsOfARayAreInclusive) {
  const Triangles triangles = square(1);
  const Scene scene = make_scene(device_, make_mesh(device_, triangles.desc()));
  const auto hits = [&](float tmin, float tmax) {
    kiwami_ray ray = ray_along_z(0.5f, 0.25f);
    ray.tmin = tmin;
    ray.tmax = tmax;
    return any_hit(scene, ray) == 1;
  };
  EXPECT_TRUE(hits(0, 1));
  EXPECT_TRUE(hits(1, 2));
  EXPECT_TRUE(hits(1, 1));
  EXPECT_FALSE(hits(0, 0.99999994f));
  EXPECT_FALSE(hits(1.0000001f, 2));
  EXPECT_FALSE(hits(2, 0));
}

TEST_F(TraceTest, BadNumbersAreExplicitMisses) {
  const Triangles triangles = square(1);
  const Scene scene = make_scene(device_, make_mesh(device_, triangles.desc()));
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const kiwami_hit miss{kInfinity,        0, 0, 0, 0, 0, KIWAMI_INVALID_ID, KIWAMI_INVALID_ID,
                        KIWAMI_INVALID_ID};
  const auto expect_miss = [&](float kiwami_ray::*member, float value) {
    kiwami_ray ray = ray_along_z(0.5f, 0.25f);
    ray.*member = value;
    EXPECT_TRUE(are_equal({closest_hit(scene, ray)}, {miss})) << value;
    EXPECT_EQ(any_hit(scene, ray), 0);
  };
  for (auto member : {&kiwami_ray::origin_x, &kiwami_ray::origin_y, &kiwami_ray::origin_z,
                      &kiwami_ray::direction_x, &kiwami_ray::direction_y, &kiwami_ray::direction_z,
                      &kiwami_ray::tmin, &kiwami_ray::tmax}) {
    expect_miss(member, nan);
  }
  for (auto member :
       {&kiwami_ray::direction_x, &kiwami_ray::direction_y, &kiwami_ray::direction_z}) {
    expect_miss(member, kInfinity);
  }
  expect_miss(&kiwami_ray::direction_z, 0);
  expect_miss(&kiwami_ray::origin_z, -1.0000001f * KIWAMI_MAX_COORDINATE);
}

}  // namespace
}  // namespace kiwami_api_tests
