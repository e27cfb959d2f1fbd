// SPDX-License-Identifier: Apache-2.0
// The kernels alone, over trees that the library did not build, against the plain oracle.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "parity/kernel_check.h"
#include "parity/kernel_tables.h"
#include "parity/test_tree.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/plain_oracle.h"

namespace kiwami_tests {
namespace {

/// Rays that are answered by the plain loop at once.
constexpr uint64_t kRaysPerBlock = 50000;

/// Compares all kernels on about count rays at a scene. The plain loop, which takes most of the
/// time, answers each ray once for all of them.
void compare_all(const Scene& scene, uint64_t count, uint64_t stream) {
  const PlainOracle oracle(scene);
  const TestTree trees[] = {TestTree(scene, 4), TestTree(scene, 8), TestTree(scene, 16)};
  for (uint64_t begin = 0; begin < count; begin += kRaysPerBlock) {
    const uint64_t rays = std::min(count - begin, kRaysPerBlock);
    const Expected expected =
        expected_of(oracle, scene, rays, Random(seed(), stream + (begin << 16)));
    for (const NamedKernels& kernels : all_kernels()) {
      const TestTree& tree = trees[kernels.width == 4 ? 0 : kernels.width == 8 ? 1 : 2];
      const std::string found = difference(kernels, tree.view(), expected);
      EXPECT_TRUE(found.empty()) << kernels.name << ", scene " << scene.name
                                 << ", KIWAMI_SEED=" << seed() << "\n"
                                 << found;
    }
  }
}

TEST(AllKernels, AgreeWithThePlainOracleOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(200));
  const uint64_t rays = ray_budget(100000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) compare_all(adversarial_scene(i, seed()), rays, i);
  std::printf("%u scenes, %llu rays on each of %zu kernel sets, KIWAMI_SEED=%llu\n", scenes,
              static_cast<unsigned long long>(rays * scenes), all_kernels().size(),
              static_cast<unsigned long long>(seed()));
}

TEST(AllKernels, AgreeWithThePlainOracleOnClosedMeshes) {
  for (const ClosedMesh& closed : closed_meshes()) {
    compare_all(scene_of(closed), ray_budget(10000) / 70 + 1, 0);
  }
}

class Kernels : public testing::TestWithParam<NamedKernels> {};

TEST_P(Kernels, AreCaughtWhenABoxIsTooSmall) {
  const ClosedMesh closed = closed_meshes().front();
  const Scene scene = scene_of(closed);
  const PlainOracle oracle(scene);
  TestTree tree(scene, GetParam().width);
  const Expected expected = expected_of(oracle, scene, 20000, Random(5));
  ASSERT_EQ(difference(GetParam(), tree.view(), expected), "");
  tree.shrink_box(0, 0.01f);
  EXPECT_NE(difference(GetParam(), tree.view(), expected), "");
}

TEST_P(Kernels, AreCaughtWhenTheOracleHasTheInclusiveEdgeRule) {
  const Scene scene = scene_of(closed_meshes().front());
  const PlainOracle wrong(scene, EdgeRule::kInclusive);
  const TestTree tree(scene, GetParam().width);
  EXPECT_NE(difference(GetParam(), tree.view(), expected_of(wrong, scene, 2000, Random(6))), "");
}

INSTANTIATE_TEST_SUITE_P(All, Kernels, testing::ValuesIn(all_kernels()),
                         [](const auto& test) { return test.param.name; });

}  // namespace
}  // namespace kiwami_tests
