// SPDX-License-Identifier: Apache-2.0
// Filters and exclusions, through the C interface on every ISA and width and on trees with
// duplicates, against the plain loop.
#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <map>
#include <mutex>
#include <string>
#include <tuple>
#include <vector>

#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

using HitList = std::vector<kiwami_hit>;

/// A filter whose answer depends on the triangle alone, and what it was asked.
class RecordingFilter {
 public:
  explicit RecordingFilter(uint32_t salt) : salt_(salt) {}

  static bool accepts(const kiwami_hit& hit, uint32_t salt) {
    uint32_t bits = (hit.primitive_id * 0x9E3779B9u) ^ (hit.geometry_id * 0x85EBCA6Bu) ^ salt;
    bits ^= bits >> 15;
    bits *= 0x2C1B3C6Du;
    return ((bits ^ (bits >> 13)) & 1u) != 0;
  }
  bool accepts(const kiwami_hit& hit) const { return accepts(hit, salt_); }

  void install(kiwami_query& query) {
    query.filter = call;
    query.filter_user = this;
  }

  /// By ray, in the order of the calls.
  std::map<uint64_t, HitList> asked;

 private:
  static int32_t call(void* user, const kiwami_filter_candidate* candidate) {
    auto& filter = *static_cast<RecordingFilter*>(user);
    EXPECT_GE(candidate->struct_size, sizeof *candidate);
    EXPECT_EQ(candidate->depth, 0u);
    EXPECT_EQ(candidate->instance_path[0], KIWAMI_INVALID_ID);
    const std::lock_guard lock(filter.mutex_);
    filter.asked[candidate->ray].push_back(candidate->hit);
    return filter.accepts(candidate->hit) ? KIWAMI_FILTER_ACCEPT : KIWAMI_FILTER_REJECT;
  }

  uint32_t salt_;
  std::mutex mutex_;
};

kiwami_query default_query() {
  kiwami_query query;
  check(kiwami_query_init(&query, sizeof query));
  return query;
}

/// What the plain loop finds, hits that do not count left out.
template <typename Counts>
std::vector<HitList> lists_of(const PlainOracle& oracle, const std::vector<kiwami_ray>& rays,
                              Counts counts) {
  std::vector<HitList> lists;
  for (size_t i = 0; i < rays.size(); ++i) {
    HitList hits = oracle.hits(rays[i]);
    hits.erase(std::remove_if(hits.begin(), hits.end(),
                              [&](const kiwami_hit& hit) { return !counts(i, hit); }),
               hits.end());
    lists.push_back(hits);
  }
  return lists;
}

/// The first ray for which a query has another answer than the lists; "" when there is none.
std::string difference(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays,
                       const kiwami_query& query, const std::vector<HitList>& lists) {
  const size_t count = rays.size();
  HitList closest(count);
  std::vector<uint8_t> any(count);
  std::vector<uint32_t> counts(count);
  check(kiwami_closest_hit(scene, rays.data(), 0, closest.data(), 0, count, &query));
  check(kiwami_any_hit(scene, rays.data(), 0, any.data(), 0, count, &query));
  check(kiwami_count_hits(scene, rays.data(), 0, counts.data(), 0, count, &query));
  for (size_t i = 0; i < count; ++i) {
    const kiwami_hit expected = lists[i].empty() ? missing_hit() : lists[i].front();
    if (!is_same(closest[i], expected) || any[i] != (lists[i].empty() ? 0 : 1) ||
        counts[i] != lists[i].size()) {
      return describe(rays[i]) + "\n  expected " + std::to_string(lists[i].size()) + ", first " +
             describe(expected) + "\n  counted " + std::to_string(counts[i]) + ", any " +
             std::to_string(any[i]) + ", closest " + describe(closest[i]);
    }
  }
  size_t total = 1;
  for (const HitList& list : lists) total += list.size();
  HitList hits(total);
  for (const uint32_t limit : {1u, 3u, 0u}) {
    std::vector<uint64_t> offsets(count + 1);
    check(kiwami_multi_hit(scene, rays.data(), 0, count, limit, hits.data(), hits.size(),
                           offsets.data(), &query));
    for (size_t i = 0; i < count; ++i) {
      const size_t wanted = limit == 0 ? lists[i].size() : std::min<size_t>(limit, lists[i].size());
      const auto begin = hits.begin() + static_cast<ptrdiff_t>(offsets[i]);
      const auto end = hits.begin() + static_cast<ptrdiff_t>(offsets[i + 1]);
      if (!std::equal(begin, end, lists[i].begin(),
                      lists[i].begin() + static_cast<ptrdiff_t>(wanted), is_same)) {
        return describe(rays[i]) + ": at most " + std::to_string(limit) + " differ";
      }
    }
  }
  return "";
}

std::vector<kiwami_ray> some_rays(const Scene& scene, size_t count, Random random) {
  RayGenerator generator(scene, random);
  std::vector<kiwami_ray> rays(count);
  for (kiwami_ray& ray : rays) ray = generator.next();
  return rays;
}

/// Trees of all widths, without and with duplicates.
std::vector<BuildOptions> some_builds() {
  std::vector<BuildOptions> builds;
  for (const uint32_t width : {4u, 8u, 16u}) {
    BuildOptions options;
    options.width = width;
    builds.push_back(options);
    options.parameters = {{KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_SPATIAL_SPLIT},
                          {KIWAMI_PARAMETER_SPLIT_BUDGET, 4.0},
                          {KIWAMI_PARAMETER_SPLIT_ALPHA, 0.0}};
    builds.push_back(options);
  }
  return builds;
}

std::vector<Scene> some_scenes() {
  std::vector<Scene> scenes;
  for (uint32_t i = 0; i < case_budget(12); ++i) scenes.push_back(adversarial_scene(i, seed()));
  for (const ClosedMesh& closed : closed_meshes()) scenes.push_back(scene_of(closed));
  return scenes;
}

/// Every triangle at most once for a ray: rays meet each once, if they do.
bool has_repeats(HitList hits) {
  const auto key = [](const kiwami_hit& hit) {
    return std::make_tuple(hit.geometry_id, hit.primitive_id);
  };
  std::sort(hits.begin(), hits.end(),
            [&](const kiwami_hit& a, const kiwami_hit& b) { return key(a) < key(b); });
  return std::adjacent_find(hits.begin(), hits.end(),
                            [&](const kiwami_hit& a, const kiwami_hit& b) {
                              return key(a) == key(b);
                            }) != hits.end();
}

class Filters : public testing::TestWithParam<uint32_t> {
 protected:
  const DeviceHandle device_ = make_device(GetParam(), 2);
};

TEST_P(Filters, LeaveTheLeastHitThatTheyAccept) {
  uint32_t salt = static_cast<uint32_t>(seed());
  for (const Scene& scene : some_scenes()) {
    const std::vector<kiwami_ray> rays =
        some_rays(scene, ray_budget(6000) / 19 + 1, Random(seed(), 800));
    const PlainOracle oracle(scene);
    for (const BuildOptions& build : some_builds()) {
      const SceneHandle built = make_scene(device_.get(), scene, build);
      RecordingFilter filter(++salt);
      const auto lists = lists_of(
          oracle, rays, [&](size_t, const kiwami_hit& hit) { return filter.accepts(hit); });
      kiwami_query query = default_query();
      filter.install(query);
      ASSERT_EQ(difference(built.get(), rays, query, lists), "")
          << scene.name << ", KIWAMI_SEED=" << seed();
    }
  }
}

TEST_P(Filters, AreAskedOfEachCrossingOnceAtMostAndInOrderForSeveralHits) {
  uint64_t asked = 0;
  for (const Scene& scene : some_scenes()) {
    const std::vector<kiwami_ray> rays = some_rays(scene, 300, Random(seed(), 801));
    const PlainOracle oracle(scene);
    for (const BuildOptions& build : some_builds()) {
      const SceneHandle built = make_scene(device_.get(), scene, build);
      HitList closest(rays.size());
      std::vector<uint32_t> counts(rays.size());
      std::vector<uint64_t> offsets(rays.size() + 1);
      for (int call = 0; call < 3; ++call) {
        RecordingFilter filter(7);
        kiwami_query query = default_query();
        filter.install(query);
        if (call == 0) {
          check(kiwami_closest_hit(built.get(), rays.data(), 0, closest.data(), 0, rays.size(),
                                   &query));
        } else if (call == 1) {
          check(kiwami_count_hits(built.get(), rays.data(), 0, counts.data(), 0, rays.size(),
                                  &query));
        } else {
          check(kiwami_multi_hit(built.get(), rays.data(), 0, rays.size(), 2, nullptr, 0,
                                 offsets.data(), &query));
        }
        for (const auto& [ray, hits] : filter.asked) {
          asked += hits.size();
          ASSERT_FALSE(has_repeats(hits)) << scene.name << ", call " << call;
          if (call != 2) continue;
          // The first hits of all, up to the second that is accepted.
          const HitList all = oracle.hits(rays[ray]);
          ASSERT_TRUE(std::equal(hits.begin(), hits.end(), all.begin(),
                                 all.begin() + static_cast<ptrdiff_t>(hits.size()), is_same));
          const auto accepted = std::count_if(
              hits.begin(), hits.end(), [&](const kiwami_hit& hit) { return filter.accepts(hit); });
          ASSERT_TRUE(hits.size() == all.size() || (accepted == 2 && filter.accepts(hits.back())));
        }
      }
    }
  }
  EXPECT_GT(asked, 0u);
}

/// Sheets at z = 0, 1, 2 ... of which a ray along z meets all.
Scene sheets(uint32_t count) {
  Scene scene{"sheets", {{}}};
  for (uint32_t i = 0; i < count; ++i) {
    const auto z = static_cast<float>(i);
    scene.meshes[0].add({-3, -3, z}, {3, -3, z}, {0, 4, z});
  }
  return scene;
}

struct Counter {
  std::atomic<uint32_t> calls{0};
  int32_t answer = KIWAMI_FILTER_ACCEPT;
  uint32_t from = 0;  ///< the first primitive that gets this answer; others are accepted
};
int32_t count_call(void* user, const kiwami_filter_candidate* candidate) {
  auto& counter = *static_cast<Counter*>(user);
  ++counter.calls;
  return candidate->hit.primitive_id >= counter.from ? counter.answer : KIWAMI_FILTER_ACCEPT;
}

TEST_P(Filters, CanStopARay) {
  const SceneHandle scene = make_scene(device_.get(), sheets(40), {});
  const kiwami_ray ray = ray_from({0.25f, 0.125f, -1.0f}, {0, 0, 1});
  Counter counter;
  counter.answer = KIWAMI_FILTER_ACCEPT_AND_STOP;
  counter.from = 35;
  kiwami_query query = default_query();
  query.filter = count_call;
  query.filter_user = &counter;
  uint64_t offsets[2];
  check(kiwami_multi_hit(scene.get(), &ray, 0, 1, 0, nullptr, 0, offsets, &query));
  EXPECT_EQ(offsets[1], 36u);
  EXPECT_EQ(counter.calls, 36u);
  counter.calls = 0;
  counter.from = 0;
  uint32_t count;
  check(kiwami_count_hits(scene.get(), &ray, 0, &count, 0, 1, &query));
  EXPECT_EQ(count, 1u);
  EXPECT_EQ(counter.calls, 1u);
  kiwami_hit hit;
  check(kiwami_closest_hit(scene.get(), &ray, 0, &hit, 0, 1, &query));
  EXPECT_NE(hit.primitive_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(counter.calls, 2u);
}

TEST_P(Filters, ThatFailEndTheCall) {
  const SceneHandle scene = make_scene(device_.get(), sheets(5), {});
  for (const size_t count : {size_t{1}, size_t{20000}}) {
    const std::vector<kiwami_ray> rays(count, ray_from({0.25f, 0.125f, -1.0f}, {0, 0, 1}));
    for (const int32_t answer : {-1, 3}) {
      Counter counter;
      counter.answer = answer;
      kiwami_query query = default_query();
      query.filter = count_call;
      query.filter_user = &counter;
      std::vector<kiwami_hit> hits(count);
      std::vector<uint8_t> any(count);
      std::vector<uint32_t> counts(count);
      std::vector<uint64_t> offsets(count + 1);
      EXPECT_EQ(kiwami_closest_hit(scene.get(), rays.data(), 0, hits.data(), 0, count, &query),
                KIWAMI_ERROR_CALLBACK);
      EXPECT_EQ(kiwami_any_hit(scene.get(), rays.data(), 0, any.data(), 0, count, &query),
                KIWAMI_ERROR_CALLBACK);
      EXPECT_EQ(kiwami_count_hits(scene.get(), rays.data(), 0, counts.data(), 0, count, &query),
                KIWAMI_ERROR_CALLBACK);
      EXPECT_EQ(kiwami_multi_hit(scene.get(), rays.data(), 0, count, 0, nullptr, 0, offsets.data(),
                                 &query),
                KIWAMI_ERROR_CALLBACK);
      EXPECT_LE(counter.calls, 4u * 8u);
    }
  }
}

TEST_P(Filters, AreToldTheNumberOfTheRayInTheCall) {
  const SceneHandle scene = make_scene(device_.get(), sheets(1), {});
  std::vector<kiwami_ray> rays(9000, ray_from({9, 9, -1}, {0, 0, 1}));
  for (const size_t i : {size_t{3}, size_t{4100}, size_t{8999}}) {
    rays[i] = ray_from({0.25f, 0.125f, -1.0f}, {0, 0, 1});
  }
  for (int call = 0; call < 2; ++call) {
    RecordingFilter filter(1);
    kiwami_query query = default_query();
    filter.install(query);
    HitList hits(rays.size());
    std::vector<uint64_t> offsets(rays.size() + 1);
    if (call == 0) {
      check(kiwami_closest_hit(scene.get(), rays.data(), 0, hits.data(), 0, rays.size(), &query));
    } else {
      check(kiwami_multi_hit(scene.get(), rays.data(), 0, rays.size(), 0, nullptr, 0,
                             offsets.data(), &query));
    }
    ASSERT_EQ(filter.asked.size(), 3u);
    EXPECT_EQ(filter.asked.count(3) + filter.asked.count(4100) + filter.asked.count(8999), 3u);
  }
}

TEST_P(Filters, ExclusionsKeepOneTriangleFromEachRay) {
  uint64_t excluded_hits = 0;
  for (const Scene& scene : some_scenes()) {
    const std::vector<kiwami_ray> rays =
        some_rays(scene, ray_budget(6000) / 19 + 1, Random(seed(), 802));
    const PlainOracle oracle(scene);
    HitList first(rays.size());
    for (size_t i = 0; i < rays.size(); ++i) first[i] = oracle.closest_hit(rays[i]);
    const auto lists = lists_of(oracle, rays, [&](size_t i, const kiwami_hit& hit) {
      const bool is_excluded =
          hit.primitive_id == first[i].primitive_id && hit.geometry_id == first[i].geometry_id;
      excluded_hits += is_excluded;
      return !is_excluded;
    });
    const std::vector<uint32_t> no_paths(8 * rays.size(), KIWAMI_INVALID_ID);
    for (const BuildOptions& build : some_builds()) {
      const SceneHandle built = make_scene(device_.get(), scene, build);
      kiwami_query query = default_query();
      query.exclusions = reinterpret_cast<const kiwami_exclusion*>(&first[0].primitive_id);
      query.exclusion_stride = sizeof(kiwami_hit);
      ASSERT_EQ(difference(built.get(), rays, query, lists), "")
          << scene.name << ", KIWAMI_SEED=" << seed();
      query.exclusion_paths = no_paths.data();
      ASSERT_EQ(difference(built.get(), rays, query, lists), "") << scene.name << ", by paths";
    }
  }
  EXPECT_GT(excluded_hits, 0u);
}

/// A triangle of the same number in another instance is met.
TEST_P(Filters, ExclusionsNameAnInstance) {
  const SceneHandle scene = make_scene(device_.get(), sheets(3), {});
  const kiwami_ray ray = ray_from({0.25f, 0.125f, -1.0f}, {0, 0, 1});
  kiwami_exclusion exclusion = {0, 0, 5};
  kiwami_query query = default_query();
  query.exclusions = &exclusion;
  kiwami_hit hit;
  check(kiwami_closest_hit(scene.get(), &ray, 0, &hit, 0, 1, &query));
  EXPECT_EQ(hit.primitive_id, 0u);
  exclusion.instance_id = KIWAMI_INVALID_ID;
  check(kiwami_closest_hit(scene.get(), &ray, 0, &hit, 0, 1, &query));
  EXPECT_EQ(hit.primitive_id, 1u);
  query.exclusions = nullptr;
  const uint32_t path[8] = {};
  query.exclusion_paths = path;
  EXPECT_EQ(kiwami_closest_hit(scene.get(), &ray, 0, &hit, 0, 1, &query),
            KIWAMI_ERROR_INVALID_ARGUMENT);
}

/// Were a filter not asked, or an exclusion not kept, the comparison would say so.
TEST_P(Filters, AreCaughtWhereTheyAreIgnored) {
  const Scene scene = scene_of(closed_meshes().front());
  const std::vector<kiwami_ray> rays = some_rays(scene, 300, Random(seed(), 803));
  const auto lists = lists_of(PlainOracle(scene), rays, [](size_t, const kiwami_hit& hit) {
    return RecordingFilter::accepts(hit, 1);
  });
  const SceneHandle built = make_scene(device_.get(), scene, {});
  EXPECT_NE(difference(built.get(), rays, default_query(), lists), "");
}

INSTANTIATE_TEST_SUITE_P(All, Filters, testing::ValuesIn(available_isas()),
                         [](const auto& test) { return std::string(kiwami_isa_name(test.param)); });

}  // namespace
}  // namespace kiwami_tests
