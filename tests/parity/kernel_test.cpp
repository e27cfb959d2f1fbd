// SPDX-License-Identifier: Apache-2.0
// The kernels alone, over trees that the library did not build, against the plain oracle.
#include <gtest/gtest.h>

#include "parity/kernel_check.h"
#include "parity/kernel_tables.h"
#include "parity/test_tree.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/plain_oracle.h"

namespace kiwami_tests {
namespace {

class Kernels : public testing::TestWithParam<NamedKernels> {};

TEST_P(Kernels, AgreeWithThePlainOracleOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(200));
  const uint64_t rays = ray_budget(100000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Scene scene = adversarial_scene(i, seed());
    const PlainOracle oracle(scene);
    const TestTree tree(scene, GetParam().width);
    const Expected expected = expected_of(oracle, scene, rays, Random(seed(), i));
    const std::string found = difference(GetParam(), tree.view(), expected);
    EXPECT_TRUE(found.empty()) << "scene " << scene.name << ", KIWAMI_SEED=" << seed() << "\n"
                               << found;
  }
}

TEST_P(Kernels, AgreeWithThePlainOracleOnClosedMeshes) {
  for (const ClosedMesh& closed : closed_meshes()) {
    const Scene scene = scene_of(closed);
    const PlainOracle oracle(scene);
    const TestTree tree(scene, GetParam().width);
    const Expected expected = expected_of(oracle, scene, ray_budget(10000) / 7, Random(seed()));
    const std::string found = difference(GetParam(), tree.view(), expected);
    EXPECT_TRUE(found.empty()) << closed.name << ", KIWAMI_SEED=" << seed() << "\n" << found;
  }
}

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
