// SPDX-License-Identifier: Apache-2.0
// The public API on every ISA, width and thread count, merged or not, against the plain oracle.
#include <gtest/gtest.h>

#include <cstring>

#include "dispatch/dispatch.h"
#include "parity/committed_tree.h"
#include "parity/kernel_check.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

/// From this many rays on a batch is spread over threads.
constexpr size_t kParallelBatch = 5000;

/// How a scene is built and traced.
struct Variant {
  uint32_t thread_count;
  BuildOptions build;

  std::string name() const {
    return "width " + std::to_string(build.width) +
           (build.merges_leaves ? ", merged" : ", not merged") + ", leaf size " +
           std::to_string(build.max_leaf_size) + ", " + std::to_string(thread_count) + " threads";
  }
};

/// Every way on one thread, and one on two: those batches are long.
std::vector<Variant> variants_of(uint32_t scene_index) {
  const uint32_t widths[] = {4, 8, 16};
  std::vector<Variant> variants{{2, {widths[scene_index % 3], true, 0, true}}};
  for (const uint32_t width : widths) {
    for (const bool merges_leaves : {true, false}) {
      for (const uint32_t max_leaf_size : {0u, 1u}) {
        variants.push_back({1, {width, merges_leaves, max_leaf_size, true}});
      }
    }
  }
  return variants;
}

/// The rays and answers again and again, until a batch is large enough for several threads.
Expected repeated(const Expected& expected) {
  Expected many = expected;
  while (!expected.rays.empty() && many.rays.size() < kParallelBatch) {
    many.rays.insert(many.rays.end(), expected.rays.begin(), expected.rays.end());
    many.hits.insert(many.hits.end(), expected.hits.begin(), expected.hits.end());
    many.counts.insert(many.counts.end(), expected.counts.begin(), expected.counts.end());
  }
  return many;
}

/// What differs between a scene's answers by all four calls and the expected ones.
std::string difference_of_scene(const kiwami_scene* scene, const Expected& expected) {
  std::string found = difference(closest_hits(scene, expected.rays), expected);
  if (found.empty()) found = difference(closest_hits_by_fields(scene, expected.rays), expected);
  if (found.empty()) found = difference(any_hits(scene, expected.rays), expected);
  if (found.empty()) found = difference(any_hits_by_fields(scene, expected.rays), expected);
  return found;
}

class Api : public testing::TestWithParam<uint32_t> {
 protected:
  void SetUp() override {
    for (const uint32_t thread_count : {1u, 2u}) {
      devices_[thread_count - 1] = make_device(GetParam(), thread_count);
    }
  }

  kiwami_device* device(uint32_t thread_count) { return devices_[thread_count - 1].get(); }

  /// Fails unless the scene runs on the kernels of the ISA that was asked for, which differ from
  /// all others where the ISA has its own.
  void expect_isa_of(const kiwami_scene* scene, uint32_t width) {
    const auto kernel = kernels_of(scene).closest_hit;
    ASSERT_EQ(kernel, kiwami::kernels_of(GetParam(), width).closest_hit);
    const auto is_native = [&](uint32_t isa) {
      return (kiwami::native_widths_of(isa) & (1u << width)) != 0;
    };
    for (const uint32_t other : available_isas()) {
      if (other == GetParam() || !is_native(other) || !is_native(GetParam())) continue;
      ASSERT_NE(kernel, kiwami::kernels_of(other, width).closest_hit);
    }
  }

 private:
  DeviceHandle devices_[2];
};

TEST_P(Api, RunsTheIsaThatWasForced) {
  const Scene scene = scene_of(closed_meshes().front());
  for (const uint32_t thread_count : {1u, 2u}) {
    EXPECT_EQ(info_of(device(thread_count)).isa, GetParam());
    EXPECT_EQ(info_of(device(thread_count)).thread_count, thread_count);
    for (const uint32_t width : {4u, 8u, 16u}) {
      const SceneHandle committed = make_scene(device(thread_count), scene, {width});
      EXPECT_EQ(info_of(committed.get()).bvh_width, width);
      expect_isa_of(committed.get(), width);
    }
  }
}

TEST_P(Api, AgreesWithThePlainOracleOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(200));
  const uint64_t rays = ray_budget(20000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Scene scene = adversarial_scene(i, seed());
    const Expected expected = expected_of(PlainOracle(scene), scene, rays, Random(seed(), i));
    const Expected many = repeated(expected);
    for (const Variant& variant : variants_of(i)) {
      const SceneHandle committed = make_scene(device(variant.thread_count), scene, variant.build);
      ASSERT_NO_FATAL_FAILURE(expect_isa_of(committed.get(), variant.build.width));
      const std::string found =
          difference_of_scene(committed.get(), variant.thread_count > 1 ? many : expected);
      ASSERT_TRUE(found.empty()) << scene.name << ", KIWAMI_SEED=" << seed() << ", "
                                 << variant.name() << ": " << found;
    }
  }
}

/// All kernels of the ISA on the trees that the library builds: also all hits and the margin.
TEST_P(Api, BuildsTreesOnWhichTheKernelsAgreeWithThePlainOracle) {
  const auto scenes = static_cast<uint32_t>(case_budget(200));
  const uint64_t rays = ray_budget(20000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Scene scene = adversarial_scene(i, seed() + 1);
    const Expected expected = expected_of(PlainOracle(scene), scene, rays, Random(seed(), i));
    for (const NamedKernels& kernels : all_kernels()) {
      if (kernels.isa != GetParam()) continue;
      for (const bool merges_leaves : {true, false}) {
        const SceneHandle committed =
            make_scene(device(1), scene, {kernels.width, merges_leaves, i % 2});
        const std::string found = difference(kernels, view_of(committed.get()), expected);
        ASSERT_TRUE(found.empty()) << scene.name << ", KIWAMI_SEED=" << seed()
                                   << (merges_leaves ? ", merged: " : ", not merged: ") << found;
      }
    }
  }
}

/// A defect in any one field of one answer is found.
TEST_P(Api, IsCaughtWhenAnAnswerIsOffByOneBit) {
  const Scene scene = scene_of(closed_meshes().front());
  const Expected expected = expected_of(PlainOracle(scene), scene, 1000, Random(1));
  const SceneHandle committed = make_scene(device(1), scene, {});
  const std::vector<kiwami_hit> right = closest_hits(committed.get(), expected.rays);
  ASSERT_EQ(difference(right, expected), "");
  for (size_t field = 0; field < sizeof(kiwami_hit) / 4; ++field) {
    std::vector<kiwami_hit> wrong = right;
    uint32_t bits;
    auto* const place = reinterpret_cast<unsigned char*>(&wrong[777]) + 4 * field;
    std::memcpy(&bits, place, sizeof bits);
    bits ^= 1;
    std::memcpy(place, &bits, sizeof bits);
    EXPECT_NE(difference(wrong, expected), "");
  }
  std::vector<uint8_t> any = any_hits(committed.get(), expected.rays);
  ASSERT_EQ(difference(any, expected), "");
  any[777] ^= 1;
  EXPECT_NE(difference(any, expected), "");
}

TEST_P(Api, IsCaughtWhenABoxIsTooSmall) {
  const Scene scene = scene_of(closed_meshes().front());
  const Expected expected = expected_of(PlainOracle(scene), scene, 4000, Random(2));
  for (const NamedKernels& kernels : all_kernels()) {
    if (kernels.isa != GetParam()) continue;
    const SceneHandle committed = make_scene(device(1), scene, {kernels.width});
    ASSERT_EQ(difference(kernels, view_of(committed.get()), expected), "");
    for (const uint32_t axis : {0u, 1u, 2u}) {
      const BrokenTree broken(committed.get(), 0, axis, 0.02f);
      EXPECT_NE(difference(kernels, broken.view(), expected), "") << kernels.name;
    }
  }
}

TEST_P(Api, IsCaughtAgainstTheInclusiveEdgeRule) {
  const Scene scene = scene_of(closed_meshes().front());
  const PlainOracle wrong(scene, EdgeRule::kInclusive);
  const SceneHandle committed = make_scene(device(1), scene, {});
  EXPECT_NE(difference_of_scene(committed.get(), expected_of(wrong, scene, 2000, Random(3))), "");
}

INSTANTIATE_TEST_SUITE_P(All, Api, testing::ValuesIn(available_isas()),
                         [](const auto& test) { return std::string(kiwami_isa_name(test.param)); });

}  // namespace
}  // namespace kiwami_tests
