// SPDX-License-Identifier: Apache-2.0
// The caller's floating-point modes change no bit, and are left as they were.
#include <gtest/gtest.h>

#include <cfenv>

#include "api/api_support.h"

#if defined(__SSE__)
#include <xmmintrin.h>
#endif

namespace kiwami_api_tests {
namespace {

/// Coordinates so small that flushing denormal numbers to zero would lose them.
Triangles tiny_triangles() {
  Triangles triangles = random_triangles(200, 21);
  for (float& coordinate : triangles.vertices) coordinate *= 0x1p-126f;
  return triangles;
}

/// Enough of them that batches run on all threads.
std::vector<kiwami_ray> tiny_rays() {
  std::vector<kiwami_ray> rays = random_rays(5000, 22);
  for (kiwami_ray& ray : rays) {
    ray.origin_x *= 0x1p-126f;
    ray.origin_y *= 0x1p-126f;
    ray.origin_z *= 0x1p-126f;
    ray.tmin *= 0x1p-126f;
    ray.tmax *= 0x1p-126f;
  }
  return rays;
}

struct Answers {
  std::vector<kiwami_hit> hits;
  std::vector<uint8_t> occluded;
  std::vector<float> t;

  bool operator==(const Answers& other) const {
    return are_equal(hits, other.hits) && occluded == other.occluded && t == other.t;
  }
};

/// Builds and traces all over again, by every trace call.
Answers build_and_trace(const Device& device, const Triangles& triangles,
                        const std::vector<kiwami_ray>& rays) {
  const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  Answers answers;
  answers.hits = closest_hits(scene, rays);
  answers.occluded.resize(rays.size());
  kiwami_any_hit(scene.get(), rays.data(), 0, answers.occluded.data(), 0, rays.size(), nullptr);
  answers.t.resize(rays.size());
  kiwami_ray_fields fields;
  kiwami_ray_fields_init(&fields, sizeof fields);
  fields.origin_x = {&rays[0].origin_x, sizeof rays[0]};
  fields.origin_y = {&rays[0].origin_y, sizeof rays[0]};
  fields.origin_z = {&rays[0].origin_z, sizeof rays[0]};
  fields.direction_x = {&rays[0].direction_x, sizeof rays[0]};
  fields.direction_y = {&rays[0].direction_y, sizeof rays[0]};
  fields.direction_z = {&rays[0].direction_z, sizeof rays[0]};
  kiwami_hit_fields hits;
  kiwami_hit_fields_init(&hits, sizeof hits);
  hits.t = {answers.t.data(), sizeof(float)};
  kiwami_closest_hit_fields(scene.get(), &fields, &hits, rays.size(), nullptr);
  return answers;
}

class FloatState : public testing::TestWithParam<unsigned> {
 protected:
  Device device() const {
    kiwami_device_desc desc = default_device();
    desc.thread_count = GetParam();
    return make_device(desc);
  }

  const Triangles triangles_ = tiny_triangles();
  const std::vector<kiwami_ray> rays_ = tiny_rays();
};

TEST_P(FloatState, TheSceneHasHitsThatModesCouldChange) {
  size_t hits = 0;
  for (const kiwami_hit& hit : build_and_trace(device(), triangles_, rays_).hits) {
    hits += hit.t < 0x1p-120f;
  }
  EXPECT_GT(hits, rays_.size() / 50);
}

TEST_P(FloatState, RoundingModesChangeNoBit) {
  const Device device = this->device();
  const Answers expected = build_and_trace(device, triangles_, rays_);
  for (int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    ASSERT_EQ(std::fesetround(mode), 0);
    const Answers answers = build_and_trace(device, triangles_, rays_);
    const int mode_after = std::fegetround();
    std::fesetround(FE_TONEAREST);
    EXPECT_EQ(mode_after, mode);
    EXPECT_TRUE(answers == expected) << mode;
  }
}

#if defined(__SSE__)
TEST_P(FloatState, FlushedDenormalsAndUnmaskedExceptionsChangeNoBit) {
  constexpr unsigned kDefault = 0x1F80, kFlushToZero = 0x8000, kDenormalsAreZero = 0x0040;
  constexpr unsigned kAllMasks = 0x1F80, kRoundUp = 0x4000;
  const Device device = this->device();
  const Answers expected = build_and_trace(device, triangles_, rays_);
  const unsigned before = _mm_getcsr();
  for (unsigned modes :
       {kDefault | kFlushToZero, kDefault | kDenormalsAreZero,
        kDefault | kFlushToZero | kDenormalsAreZero | kRoundUp, kDefault & ~kAllMasks}) {
    const Scene scene = make_scene(device, make_mesh(device, triangles_.desc()));
    std::vector<kiwami_hit> hits(rays_.size());
    _mm_setcsr(modes);
    const kiwami_result committed = kiwami_scene_commit(scene.get());
    const kiwami_result traced =
        kiwami_closest_hit(scene.get(), rays_.data(), 0, hits.data(), 0, rays_.size(), nullptr);
    const unsigned after = _mm_getcsr();
    _mm_setcsr(before);
    EXPECT_EQ(committed, KIWAMI_OK);
    EXPECT_EQ(traced, KIWAMI_OK);
    EXPECT_EQ(after, modes);
    EXPECT_TRUE(are_equal(hits, expected.hits)) << std::hex << modes;
  }
}
#endif

// On the calling thread alone, and on the library's threads, which inherit modes from nobody.
INSTANTIATE_TEST_SUITE_P(Threads, FloatState, testing::Values(1u, 2u));

}  // namespace
}  // namespace kiwami_api_tests
