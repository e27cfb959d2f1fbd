// SPDX-License-Identifier: Apache-2.0
// The lists of hits that the multi-hit kernels make, against the plain loop's, bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <vector>

#include "parity/kernel_tables.h"
#include "parity/split_scene.h"
#include "parity/test_tree.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/feature_rays.h"
#include "support/plain_oracle.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

using HitList = std::vector<kiwami_hit>;

/// 0: all.
constexpr uint32_t kLimits[] = {1, 2, 8, 64, 0};

struct ListedRays {
  std::vector<kiwami_ray> rays;
  std::vector<HitList> hits;  ///< all of each ray
};

ListedRays with_hits(const PlainOracle& oracle, std::vector<kiwami_ray> rays) {
  ListedRays listed{std::move(rays), {}};
  for (const kiwami_ray& ray : listed.rays) listed.hits.push_back(oracle.hits(ray));
  return listed;
}

std::vector<kiwami_ray> random_rays(const Scene& scene, size_t count, Random random) {
  RayGenerator generator(scene, random);
  std::vector<kiwami_ray> rays(count);
  for (kiwami_ray& ray : rays) ray = generator.next();
  return rays;
}

kiwami::RayBatch batch_of(const kiwami_ray* rays, size_t count, uint32_t* counts) {
  return {reinterpret_cast<const unsigned char*>(rays), sizeof(kiwami_ray),
          reinterpret_cast<unsigned char*>(counts), sizeof(uint32_t), count};
}

/// By the kernel that keeps lists sorted.
std::vector<HitList> run_nearest_hits(const NamedKernels& named, const kiwami::SceneView& view,
                                      const std::vector<kiwami_ray>& rays, uint32_t limit) {
  std::vector<uint32_t> counts(rays.size());
  std::vector<kiwami_hit> hits(rays.size() * limit);
  std::vector<kiwami::HitKey> keys(rays.size() * limit);
  named.kernels.multi_hit.nearest(view, batch_of(rays.data(), rays.size(), counts.data()),
                                  {hits.data(), keys.data(), limit});
  std::vector<HitList> lists(rays.size());
  for (size_t i = 0; i < rays.size(); ++i) {
    for (size_t k = 0; k < counts[i]; ++k) {
      lists[i].push_back(hits[i * limit + keys[i * limit + k].slot]);
    }
  }
  return lists;
}

/// By the kernel that collects, in a room that is small at first.
std::vector<HitList> run_many_hits(const NamedKernels& named, const kiwami::SceneView& view,
                                   const std::vector<kiwami_ray>& rays, uint32_t limit) {
  std::vector<HitList> lists;
  std::vector<kiwami_hit> hits(3);
  std::vector<kiwami::HitKey> keys(3);
  while (lists.size() < rays.size()) {
    const size_t count =
        named.kernels.multi_hit.many(view, batch_of(&rays[lists.size()], 1, nullptr),
                                     {hits.data(), keys.data(), hits.size(), limit});
    if (count <= hits.size()) {
      lists.emplace_back(hits.begin(), hits.begin() + static_cast<ptrdiff_t>(count));
      continue;
    }
    hits.resize(2 * hits.size());
    keys.resize(hits.size());
  }
  return lists;
}

std::string describe(const HitList& hits) {
  std::string text;
  for (const kiwami_hit& hit : hits) text += "\n    " + kiwami_tests::describe(hit);
  return text;
}

bool are_same(const HitList& a, const HitList& b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), is_same);
}

std::string list_difference(const std::vector<HitList>& lists, const ListedRays& listed,
                            uint32_t limit) {
  for (size_t i = 0; i < lists.size(); ++i) {
    HitList expected = listed.hits[i];
    if (limit != 0 && expected.size() > limit) expected.resize(limit);
    if (are_same(lists[i], expected)) continue;
    return "at most " + std::to_string(limit) + ", ray " + std::to_string(i) + ": " +
           kiwami_tests::describe(listed.rays[i]) + "\n  oracle" + describe(expected) +
           "\n  answer" + describe(lists[i]);
  }
  return "";
}

/// The first ray whose list differs; "" when there is none.
std::string list_difference(const NamedKernels& named, const kiwami::SceneView& view,
                            const ListedRays& listed, uint32_t limit) {
  std::string found =
      list_difference(run_many_hits(named, view, listed.rays, limit), listed, limit);
  if (!found.empty()) return named.name + ", many: " + found;
  if (limit == 0 || limit > 1000) return "";
  found = list_difference(run_nearest_hits(named, view, listed.rays, limit), listed, limit);
  return found.empty() ? "" : named.name + ", nearest: " + found;
}

/// All limits and kernels, on trees with and without duplicates.
std::string list_difference(const Scene& scene, const ListedRays& listed) {
  const TestTree trees[] = {TestTree(scene, 4), TestTree(scene, 8), TestTree(scene, 16)};
  const SplitScene split(scene);
  for (const NamedKernels& kernels : all_kernels()) {
    for (const uint32_t limit : kLimits) {
      const auto& plain = trees[kernels.width == 4 ? 0 : kernels.width == 8 ? 1 : 2].view();
      std::string found = list_difference(kernels, plain, listed, limit);
      if (!found.empty()) return found;
      found = list_difference(kernels, split.view(kernels.width), listed, limit);
      if (!found.empty()) return "split, " + found;
    }
  }
  return "";
}

TEST(MultiHitKernels, AgreeWithThePlainLoopOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(40));
  const uint64_t rays = ray_budget(8000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Scene scene = adversarial_scene(i, seed());
    const ListedRays listed =
        with_hits(PlainOracle(scene), random_rays(scene, rays, Random(seed(), 700 + i)));
    EXPECT_EQ(list_difference(scene, listed), "")
        << "scene " << scene.name << ", KIWAMI_SEED=" << seed();
  }
}

TEST(MultiHitKernels, AgreeOnClosedMeshesWhoseOutsideSegmentsHaveAnEvenNumber) {
  for (const ClosedMesh& closed : closed_meshes()) {
    FeatureRayGenerator generator(closed, Random(seed(), 710));
    std::vector<kiwami_ray> rays(ray_budget(3000) / 7 + 1);
    for (kiwami_ray& ray : rays) ray = generator.outside_segment();
    const Scene scene = scene_of(closed);
    const ListedRays listed = with_hits(PlainOracle(scene), rays);
    for (const HitList& hits : listed.hits) {
      ASSERT_EQ(hits.size() % 2, 0u) << closed.name << ", KIWAMI_SEED=" << seed();
    }
    EXPECT_EQ(list_difference(scene, listed), "") << closed.name << ", KIWAMI_SEED=" << seed();
  }
}

/// Sheets across z in a random order, now and then several at one place, in two geometries.
Scene pile_of_sheets(uint32_t count, Random random) {
  Scene scene{"sheets", {{}, {}}};
  float z = 0.0f;
  for (uint32_t i = 0; i < count; ++i) {
    if (!random.one_in(4)) z = static_cast<float>(random.below(4 * count));
    scene.meshes[random.below(2)].add({-3, -3, z}, {3, -3, z}, {0, 4, z});
  }
  return scene;
}

TEST(MultiHitKernels, ListManySheetsOfWhichSomeLieInOnePlane) {
  for (const uint32_t count : {100u, 1000u}) {
    const Scene scene = pile_of_sheets(count, Random(seed(), count));
    std::vector<kiwami_ray> rays;
    for (const float side : {-1.0f, 1.0f}) {
      rays.push_back(ray_from({0.25f, 0.125f, side * -5000.0f}, {0, 0, side}));
      rays.push_back(ray_from({0.3f, -0.2f, side * -5000.0f}, {0x1p-15f, -0x1p-16f, side}));
    }
    const ListedRays listed = with_hits(PlainOracle(scene), rays);
    ASSERT_EQ(listed.hits[0].size(), count);
    EXPECT_EQ(list_difference(scene, listed), "") << "KIWAMI_SEED=" << seed();
    for (const NamedKernels& kernels : all_kernels()) {
      const TestTree tree(scene, kernels.width);
      for (const uint32_t limit : {99u, 100u, 150u, 600u, ~0u}) {
        EXPECT_EQ(list_difference(kernels, tree.view(), listed, limit), "");
      }
    }
  }
}

/// A list that is off by one hit, in any way, does not pass.
TEST(MultiHitKernels, AreCaughtWhenAListIsWrong) {
  const Scene scene = pile_of_sheets(10, Random(1));
  const TestTree tree(scene, 4);
  const NamedKernels kernels = all_kernels().front();
  const ListedRays right =
      with_hits(PlainOracle(scene), {ray_from({0.25f, 0.125f, -100.0f}, {0, 0, 1})});
  ASSERT_EQ(list_difference(kernels, tree.view(), right, 0), "");
  ListedRays wrong = right;
  std::swap(wrong.hits[0][3], wrong.hits[0][4]);
  EXPECT_NE(list_difference(kernels, tree.view(), wrong, 0), "");
  wrong = right;
  wrong.hits[0].push_back(wrong.hits[0].back());
  EXPECT_NE(list_difference(kernels, tree.view(), wrong, 0), "");
  wrong = right;
  wrong.hits[0].pop_back();
  EXPECT_NE(list_difference(kernels, tree.view(), wrong, 0), "");
}

}  // namespace
}  // namespace kiwami_tests
