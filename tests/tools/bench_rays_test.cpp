// SPDX-License-Identifier: Apache-2.0
// The ray sets of the benchmark are what they are called, and Embree's entrances agree on them.
#include "measure/bench_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <set>

#include "measure/embree_contender.h"
#include "measure/library.h"
#include "measure/parallel_blocks.h"
#include "scene/procedural.h"

namespace kiwami::tools {
namespace {

constexpr size_t kCount = 1003;

class BenchRaySets : public testing::Test {
 protected:
  BenchRays make(const std::string& name) const {
    return make_bench_rays(scene_, view(), box(), {name}, kCount).front();
  }
  Box box() const { return bounds_of(scene_.info()); }
  View view() const { return default_view(file_, box(), 1.0f); }

  SceneFile file_ = *make_procedural_scene("terrain:30");
  Device device_{KIWAMI_ISA_SCALAR, 1};
  BuiltScene scene_{device_, file_};
};

std::vector<std::string> sorted_bytes(const RaySet& set) {
  std::vector<std::string> all;
  for (const kiwami_ray& ray : set.rays) {
    std::string bytes(sizeof ray, '\0');
    std::memcpy(bytes.data(), &ray, sizeof ray);
    all.push_back(bytes);
  }
  std::sort(all.begin(), all.end());
  return all;
}

float distance_between(const kiwami_ray& a, const kiwami_ray& b) {
  return length(Vec3{a.origin_x, a.origin_y, a.origin_z} -
                Vec3{b.origin_x, b.origin_y, b.origin_z});
}

/// The sum of the distances from each origin to the next.
double path_length(const RaySet& set) {
  double sum = 0.0;
  for (size_t i = 1; i < set.rays.size(); ++i) {
    sum += distance_between(set.rays[i - 1], set.rays[i]);
  }
  return sum;
}

TEST_F(BenchRaySets, HaveTheirNamesSizesAndQueries) {
  for (const std::string& name : bench_ray_names()) {
    const BenchRays rays = make(name);
    EXPECT_EQ(rays.set.name, name);
    EXPECT_EQ(rays.set.rays.size(), name == "primary" ? 31u * 31u : kCount);
    EXPECT_EQ(rays.any_hit, name == "ao" || name == "shadow");
    EXPECT_EQ(sorted_bytes(rays.set), sorted_bytes(make(name).set)) << name;
  }
}

TEST_F(BenchRaySets, TheShuffledBouncesAreTheBouncesInAnotherOrder) {
  const RaySet bounce = make("bounce").set;
  const RaySet shuffled = make("bounce_shuffled").set;
  EXPECT_EQ(sorted_bytes(bounce), sorted_bytes(shuffled));
  EXPECT_LT(2.0 * path_length(bounce), path_length(shuffled));
}

TEST_F(BenchRaySets, OcclusionReachesAFifthOfTheDiagonal) {
  for (const kiwami_ray& ray : make("ao").set.rays) {
    EXPECT_EQ(ray.tmax, 0.2f * box().diagonal());
    EXPECT_NEAR(length(Vec3{ray.direction_x, ray.direction_y, ray.direction_z}), 1.0f, 1e-5f);
  }
}

TEST_F(BenchRaySets, ShadowRaysEndInSixteenLights) {
  std::set<std::array<int, 3>> lights;
  for (const kiwami_ray& ray : make("shadow").set.rays) {
    EXPECT_EQ(ray.tmax, 1.0f);
    lights.insert({static_cast<int>(std::lround((ray.origin_x + ray.direction_x) * 1e4f)),
                   static_cast<int>(std::lround((ray.origin_y + ray.direction_y) * 1e4f)),
                   static_cast<int>(std::lround((ray.origin_z + ray.direction_z) * 1e4f))});
  }
  // Rounding may put a light into two neighbouring cells.
  EXPECT_GE(lights.size(), 16u);
  EXPECT_LE(lights.size(), 32u);
}

TEST_F(BenchRaySets, NothingToStartFromIsAnError) {
  View away = view();
  away.target = away.eye + (away.eye - away.target);
  EXPECT_THROW(make_bench_rays(scene_, away, box(), {"bounce"}, kCount), SceneError);
  EXPECT_NO_THROW(make_bench_rays(scene_, away, box(), {"primary", "random"}, kCount));
}

TEST_F(BenchRaySets, OneCallARayAnswersAsABatch) {
  for (const std::string& name : bench_ray_names()) {
    const std::vector<kiwami_ray> rays = make(name).set.rays;
    std::vector<kiwami_hit> batch(rays.size());
    std::vector<kiwami_hit> singly(rays.size());
    scene_.closest_hits(rays, batch);
    scene_.closest_hits_singly(rays, singly);
    EXPECT_EQ(std::memcmp(batch.data(), singly.data(), rays.size() * sizeof batch[0]), 0) << name;
    std::vector<uint8_t> any(rays.size());
    std::vector<uint8_t> any_singly(rays.size());
    scene_.any_hits(rays, any);
    scene_.any_hits_singly(rays, any_singly);
    EXPECT_EQ(any, any_singly) << name;
  }
}

TEST_F(BenchRaySets, EveryEntranceOfEmbreeAnswersAsWeDo) {
  const auto embree = EmbreeContender::create(file_, {KIWAMI_ISA_SSE, 1, true});
  if (!embree) GTEST_SKIP() << "built without Embree";
  EXPECT_GT(embree->bytes(), 0u);
  for (const std::string& name : bench_ray_names()) {
    const BenchRays rays = make(name);
    std::vector<kiwami_hit> hits(rays.set.rays.size());
    scene_.closest_hits(rays.set.rays, hits);
    for (const EmbreeEntrance entrance : kEmbreeEntrances) {
      const auto run = embree->prepare(rays.set.rays, rays.any_hit, entrance);
      for (const uint32_t threads : {1u, 3u}) {
        run->reset();
        run->trace(threads);
        size_t different = 0;
        for (size_t i = 0; i < hits.size(); ++i) {
          const float expected = rays.any_hit && is_hit(hits[i]) ? 0.0f : hits[i].t;
          const float answer = run->distance(i);
          if (answer != expected && !(std::abs(answer - expected) < 1e-4f)) ++different;
        }
        EXPECT_LE(different, 1u) << name << ", " << entrance_name(entrance, rays.any_hit);
      }
      run->reset();
      size_t answered = 0;
      for (size_t i = 0; i < hits.size(); ++i) answered += std::isfinite(run->distance(i)) ? 1 : 0;
      EXPECT_EQ(answered, 0u) << entrance_name(entrance, rays.any_hit);
    }
  }
}

TEST(ParallelBlocks, EachElementIsMetOnce) {
  for (const size_t threads : {1u, 2u, 5u}) {
    for (const size_t count : {0u, 1u, 63u, 64u, 65u, 1000u}) {
      std::vector<std::atomic<int>> visits(count);
      parallel_blocks(threads, count, 64, [&](size_t first, size_t last) {
        EXPECT_LT(first, last);
        EXPECT_LE(last - first, 64u);
        for (size_t i = first; i < last; ++i) ++visits[i];
      });
      for (const auto& visit : visits) EXPECT_EQ(visit.load(), 1);
    }
  }
}

}  // namespace
}  // namespace kiwami::tools
