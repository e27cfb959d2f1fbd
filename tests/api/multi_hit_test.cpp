// SPDX-License-Identifier: Apache-2.0
// Several hits a ray, and their number: offsets, capacities, fields, threads, bad input.
#include <gtest/gtest.h>

#include <cstring>

#include "api/api_support.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

struct Lists {
  kiwami_result result;
  std::vector<uint64_t> offsets;
  std::vector<kiwami_hit> hits;
};

/// A hit that the library does not make.
kiwami_hit untouched_hit() {
  kiwami_hit hit;
  std::memset(&hit, 0x5A, sizeof hit);
  return hit;
}

Lists multi_hit(const Scene& scene, const std::vector<kiwami_ray>& rays, uint32_t max_hits,
                uint64_t capacity, const kiwami_query* query = nullptr) {
  Lists lists{0, std::vector<uint64_t>(rays.size() + 1, 77),
              std::vector<kiwami_hit>(capacity + 1, untouched_hit())};
  lists.result = kiwami_multi_hit(scene.get(), rays.data(), 0, rays.size(), max_hits,
                                  lists.hits.data(), capacity, lists.offsets.data(), query);
  const kiwami_hit beyond = lists.hits.back(), untouched = untouched_hit();
  EXPECT_EQ(std::memcmp(&beyond, &untouched, sizeof beyond), 0);
  lists.hits.pop_back();
  return lists;
}

/// With as much capacity as is needed.
Lists multi_hit(const Scene& scene, const std::vector<kiwami_ray>& rays, uint32_t max_hits) {
  std::vector<uint64_t> offsets(rays.size() + 1);
  EXPECT_EQ(kiwami_multi_hit(scene.get(), rays.data(), 0, rays.size(), max_hits, nullptr, 0,
                             offsets.data(), nullptr),
            KIWAMI_OK)
      << last_error();
  const Lists lists = multi_hit(scene, rays, max_hits, offsets.back());
  EXPECT_EQ(lists.result, KIWAMI_OK) << last_error();
  EXPECT_EQ(lists.offsets, offsets);
  return lists;
}

/// Two thick clouds of triangles, in two geometries.
class MultiHit : public testing::Test {
 protected:
  Scene scene_of(const Device& device) const {
    Scene scene = make_scene(device);
    for (const Triangles* triangles : {&first_, &second_}) {
      const Geometry mesh = make_mesh(device, triangles->desc());
      EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    }
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    return scene;
  }

  const Triangles first_ = random_triangles(3000, kiwami_tests::seed());
  const Triangles second_ = random_triangles(2000, kiwami_tests::seed() + 1);
  const Device device_ = make_device();
  const Scene scene_ = scene_of(device_);
  const std::vector<kiwami_ray> rays_ = random_rays(20000, kiwami_tests::seed());
};

TEST_F(MultiHit, ListsEachHitOnceInOrderAndAgreesWithTheOtherCalls) {
  const Lists all = multi_hit(scene_, rays_, 0);
  const std::vector<kiwami_hit> closest = closest_hits(scene_, rays_);
  std::vector<uint32_t> counts(rays_.size());
  ASSERT_EQ(
      kiwami_count_hits(scene_.get(), rays_.data(), 0, counts.data(), 0, rays_.size(), nullptr),
      KIWAMI_OK);
  EXPECT_GT(all.hits.size(), rays_.size());
  EXPECT_EQ(all.offsets[0], 0u);
  for (size_t i = 0; i < rays_.size(); ++i) {
    const uint64_t begin = all.offsets[i], end = all.offsets[i + 1];
    ASSERT_EQ(end - begin, counts[i]);
    ASSERT_EQ(begin == end, closest[i].primitive_id == KIWAMI_INVALID_ID);
    ASSERT_TRUE(begin == end || are_equal({all.hits[begin]}, {closest[i]}));
    for (uint64_t k = begin + 1; k < end; ++k) {
      const kiwami_hit &a = all.hits[k - 1], &b = all.hits[k];
      ASSERT_TRUE(a.t < b.t || (a.t == b.t && (a.geometry_id < b.geometry_id ||
                                               (a.geometry_id == b.geometry_id &&
                                                a.primitive_id < b.primitive_id))));
    }
  }
}

TEST_F(MultiHit, AtMostSoManyAreTheFirstOfAll) {
  const Lists all = multi_hit(scene_, rays_, 0);
  for (const uint32_t limit : {1u, 3u, 64u, 70u}) {
    const Lists some = multi_hit(scene_, rays_, limit);
    for (size_t i = 0; i < rays_.size(); ++i) {
      const uint64_t count = std::min<uint64_t>(limit, all.offsets[i + 1] - all.offsets[i]);
      ASSERT_EQ(some.offsets[i + 1] - some.offsets[i], count);
      for (uint64_t k = 0; k < count; ++k) {
        ASSERT_TRUE(are_equal({some.hits[some.offsets[i] + k]}, {all.hits[all.offsets[i] + k]}));
      }
    }
  }
}

TEST_F(MultiHit, DoesNotDependOnThreadsNorOnTheSizeOfTheBatch) {
  const Lists expected = multi_hit(scene_, rays_, 5);
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.flags = KIWAMI_QUERY_CALLING_THREAD;
  const Lists alone = multi_hit(scene_, rays_, 5, expected.hits.size(), &query);
  EXPECT_EQ(alone.offsets, expected.offsets);
  EXPECT_TRUE(are_equal(alone.hits, expected.hits));
  kiwami_device_desc desc = default_device();
  ThreadRunner runner;
  runner.threads = 3;
  runner.install(desc, 3);
  const Device device = make_device(desc);
  const Lists other = multi_hit(scene_of(device), rays_, 5);
  EXPECT_GT(runner.loops, 0u);
  EXPECT_EQ(other.offsets, expected.offsets);
  EXPECT_TRUE(are_equal(other.hits, expected.hits));
  for (const size_t i : {size_t{0}, size_t{777}, rays_.size() - 1}) {
    const Lists one = multi_hit(scene_, {rays_[i]}, 5);
    EXPECT_TRUE(are_equal(one.hits,
                          {expected.hits.begin() + static_cast<int64_t>(expected.offsets[i]),
                           expected.hits.begin() + static_cast<int64_t>(expected.offsets[i + 1])}));
  }
}

TEST_F(MultiHit, ATooSmallCapacityLosesNothingBelowItAndTellsWhatIsNeeded) {
  const Lists all = multi_hit(scene_, rays_, 0);
  const uint64_t total = all.hits.size();
  for (const uint64_t capacity : {uint64_t{0}, uint64_t{1}, total / 3, total - 1}) {
    const Lists cut = multi_hit(scene_, rays_, 0, capacity);
    EXPECT_EQ(cut.result, KIWAMI_ERROR_CAPACITY);
    EXPECT_EQ(last_error(device_.get()), "hit_capacity is " + std::to_string(capacity) +
                                             ", expected at least " + std::to_string(total));
    EXPECT_EQ(cut.offsets, all.offsets);
    EXPECT_TRUE(
        are_equal(cut.hits, {all.hits.begin(), all.hits.begin() + static_cast<int64_t>(capacity)}));
  }
  EXPECT_EQ(multi_hit(scene_, rays_, 0, total + 5).result, KIWAMI_OK);
}

TEST_F(MultiHit, NoRaysHaveNoHits) {
  const Lists none = multi_hit(scene_, {}, 0);
  EXPECT_EQ(none.offsets, std::vector<uint64_t>{0});
  EXPECT_EQ(kiwami_count_hits(scene_.get(), nullptr, 0, nullptr, 0, 0, nullptr), KIWAMI_OK);
}

/// Fields that lie in arrays of structs, where they can be compared.
kiwami_ray_fields fields_of(const std::vector<kiwami_ray>& rays) {
  kiwami_ray_fields fields;
  kiwami_ray_fields_init(&fields, sizeof fields);
  const auto field = [](const void* data) { return kiwami_input_field{data, sizeof(kiwami_ray)}; };
  const kiwami_ray& ray = rays[0];
  fields.origin_x = field(&ray.origin_x);
  fields.origin_y = field(&ray.origin_y);
  fields.origin_z = field(&ray.origin_z);
  fields.direction_x = field(&ray.direction_x);
  fields.direction_y = field(&ray.direction_y);
  fields.direction_z = field(&ray.direction_z);
  fields.tmin = field(&ray.tmin);
  fields.tmax = field(&ray.tmax);
  fields.mask = field(&ray.mask);
  fields.flags = field(&ray.flags);
  return fields;
}

TEST_F(MultiHit, FieldsGiveTheBitsOfTheArrayForm) {
  const Lists expected = multi_hit(scene_, rays_, 3);
  const kiwami_ray_fields rays = fields_of(rays_);
  std::vector<uint64_t> offsets(rays_.size() + 1);
  ASSERT_EQ(kiwami_multi_hit_fields(scene_.get(), &rays, rays_.size(), 3, nullptr, 0,
                                    offsets.data(), nullptr),
            KIWAMI_OK)
      << last_error();
  EXPECT_EQ(offsets, expected.offsets);
  std::vector<float> t(expected.hits.size());
  std::vector<uint32_t> primitive(2 * expected.hits.size(), 9);
  kiwami_hit_fields hits;
  kiwami_hit_fields_init(&hits, sizeof hits);
  hits.t = {t.data(), 4};
  hits.primitive_id = {primitive.data(), 8};
  ASSERT_EQ(kiwami_multi_hit_fields(scene_.get(), &rays, rays_.size(), 3, &hits, t.size(),
                                    offsets.data(), nullptr),
            KIWAMI_OK);
  for (size_t i = 0; i < t.size(); ++i) {
    ASSERT_EQ(t[i], expected.hits[i].t);
    ASSERT_EQ(primitive[2 * i], expected.hits[i].primitive_id);
    ASSERT_EQ(primitive[2 * i + 1], 9u);
  }
  EXPECT_EQ(kiwami_multi_hit_fields(scene_.get(), &rays, rays_.size(), 3, &hits, t.size() - 1,
                                    offsets.data(), nullptr),
            KIWAMI_ERROR_CAPACITY);
}

TEST_F(MultiHit, CountsGoToFieldsAndToAnyAddress) {
  std::vector<uint32_t> expected(rays_.size());
  ASSERT_EQ(
      kiwami_count_hits(scene_.get(), rays_.data(), 0, expected.data(), 0, rays_.size(), nullptr),
      KIWAMI_OK);
  const kiwami_ray_fields rays = fields_of(rays_);
  std::vector<unsigned char> bytes(7 * rays_.size() + 1, 9);
  const kiwami_output_field counts{bytes.data() + 1, 7};
  ASSERT_EQ(kiwami_count_hits_fields(scene_.get(), &rays, &counts, rays_.size(), nullptr),
            KIWAMI_OK);
  for (size_t i = 0; i < rays_.size(); ++i) {
    ASSERT_EQ(std::memcmp(&bytes[1 + 7 * i], &expected[i], 4), 0);
    ASSERT_EQ(bytes[1 + 7 * i + 4], 9);
  }
}

TEST_F(MultiHit, BadArgumentsAreNamed) {
  uint64_t offsets[2];
  kiwami_hit hit;
  uint32_t number;
  const kiwami_ray* ray = rays_.data();
  const auto call = [&](const kiwami_scene* scene, kiwami_hit* hits, uint64_t* ends) {
    return kiwami_multi_hit(scene, ray, 0, 1, 1, hits, 1, ends, nullptr);
  };
  EXPECT_EQ(call(nullptr, &hit, offsets), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(call(scene_.get(), &hit, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "offsets is NULL, expected a valid pointer");
  EXPECT_EQ(call(scene_.get(), nullptr, offsets), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(),
            "hits is NULL with a hit_capacity of 1, expected an array, or a hit_capacity of 0 to "
            "count hits alone");
  EXPECT_EQ(call(make_scene(device_).get(), &hit, offsets), KIWAMI_ERROR_INVALID_STATE);
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.flags = 8;
  EXPECT_EQ(kiwami_multi_hit(scene_.get(), ray, 0, 1, 1, &hit, 1, offsets, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_count_hits(nullptr, ray, 0, &number, 0, 1, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_count_hits_fields(scene_.get(), nullptr, nullptr, 1, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
}

TEST_F(MultiHit, ValidationChecksArrays) {
  kiwami_device_desc desc = default_device();
  desc.flags = KIWAMI_DEVICE_VALIDATE;
  const Device device = make_device(desc);
  const Scene scene = scene_of(device);
  uint64_t offsets[2];
  uint32_t number = 0;
  EXPECT_EQ(kiwami_multi_hit(scene.get(), rays_.data(), 47, 1, 1, nullptr, 0, offsets, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "the stride of rays is 47, expected at least 48, or 0 for 48");
  EXPECT_EQ(kiwami_multi_hit(scene.get(), nullptr, 0, 1, 1, nullptr, 0, offsets, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_count_hits(scene.get(), rays_.data(), 0, &number, 3, 1, nullptr),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(multi_hit(scene, rays_, 2).result, KIWAMI_OK);
}

TEST_F(MultiHit, EveryFailedAllocationIsAnErrorAndLeaksNothing) {
  CountingAllocator allocator;
  kiwami_device_desc desc = default_device();
  ThreadRunner runner;
  runner.install(desc, 2);
  allocator.install(desc);
  {
    const Device device = make_device(desc);
    const Scene scene = scene_of(device);
    const std::vector<kiwami_ray> rays(rays_.begin(), rays_.begin() + 6000);
    const uint64_t capacity = multi_hit(scene, rays, 0).hits.size();
    const size_t live = allocator.live_bytes;
    size_t failures = 0;
    for (size_t later = 0;; ++later) {
      allocator.first_failure = allocator.calls + later;
      const Lists lists = multi_hit(scene, rays, 0, capacity);
      ASSERT_EQ(allocator.live_bytes, live);
      if (lists.result == KIWAMI_OK) break;
      ASSERT_EQ(lists.result, KIWAMI_ERROR_OUT_OF_MEMORY) << last_error();
      ++failures;
    }
    EXPECT_GT(failures, 2u);
  }
  EXPECT_EQ(allocator.live_blocks, 0u);
  EXPECT_EQ(allocator.mismatches, 0u);
}

}  // namespace
}  // namespace kiwami_api_tests
