// SPDX-License-Identifier: Apache-2.0
// Trees whose leaves hold ids alone, by all kernels against the plain loop, to the bit.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "bvh/triangle_source.h"
#include "parity/committed_tree.h"
#include "parity/kernel_check.h"
#include "parity/kernel_tables.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/plain_oracle.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

/// A scene in the compact layout, for each width; where it divides space, as much as it can.
class CompactScene {
 public:
  CompactScene(const Scene& scene, bool divides_space)
      : device_(make_device(KIWAMI_ISA_SCALAR, 1)) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      BuildOptions options;
      options.width = width;
      options.validates = true;
      options.parameters = {{KIWAMI_PARAMETER_LAYOUT, KIWAMI_LAYOUT_COMPACT}};
      if (divides_space) {
        options.parameters.insert(options.parameters.end(),
                                  {{KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_SPATIAL_SPLIT},
                                   {KIWAMI_PARAMETER_SPLIT_BUDGET, 4.0},
                                   {KIWAMI_PARAMETER_SPLIT_ALPHA, 0.0}});
      }
      scenes_[width / 8] = make_scene(device_.get(), scene, options);
    }
  }

  const kiwami::SceneView& view(uint32_t width) const { return view_of(scenes_[width / 8].get()); }

  /// "" where all kernels answer as expected.
  std::string difference_of_all(const Expected& expected) const {
    for (const NamedKernels& kernels : all_kernels(kiwami::LeafLayout::kIndices)) {
      const std::string found = difference(kernels, view(kernels.width), expected);
      if (!found.empty()) return found;
    }
    return "";
  }

 private:
  DeviceHandle device_;
  SceneHandle scenes_[3];
};

TEST(CompactTrees, AgreeWithThePlainLoopOnAdversarialScenes) {
  const auto scenes = static_cast<uint32_t>(case_budget(60));
  const uint64_t rays = ray_budget(30000) / scenes + 1;
  for (uint32_t i = 0; i < scenes; ++i) {
    const Scene scene = adversarial_scene(i, seed());
    const Expected expected = expected_of(PlainOracle(scene), scene, rays, Random(seed(), 700 + i));
    EXPECT_EQ(CompactScene(scene, i % 3 == 0).difference_of_all(expected), "")
        << "scene " << scene.name << ", KIWAMI_SEED=" << seed();
  }
}

TEST(CompactTrees, AgreeWithThePlainLoopOnClosedMeshes) {
  const std::vector<ClosedMesh> meshes = closed_meshes();
  for (size_t i = 0; i < meshes.size(); ++i) {
    const Scene scene = scene_of(meshes[i]);
    const Expected expected =
        expected_of(PlainOracle(scene), scene, ray_budget(10000) / 7 + 1, Random(seed(), 800 + i));
    EXPECT_EQ(CompactScene(scene, i % 2 == 0).difference_of_all(expected), "")
        << "scene " << scene.name << ", KIWAMI_SEED=" << seed();
  }
}

/// Many meshes of few triangles, so that a leaf holds triangles of several.
TEST(CompactTrees, AgreeWithThePlainLoopWhereLeavesMixMeshes) {
  Scene scene{"pieces", {}};
  for (const ClosedMesh& closed : closed_meshes()) {
    Mesh whole = scene_of(closed).meshes[0];
    whole.triangles.resize(std::min<size_t>(whole.triangles.size(), 60));
    for (size_t first = 0; first < whole.triangles.size(); first += 3) {
      Mesh piece = whole;
      const auto begin = whole.triangles.begin() + static_cast<ptrdiff_t>(first);
      const size_t count = std::min<size_t>(3, whole.triangles.size() - first);
      piece.triangles.assign(begin, begin + static_cast<ptrdiff_t>(count));
      piece.mask = first % 2 == 0 ? ~0u : 5;
      scene.meshes.push_back(std::move(piece));
    }
  }
  ASSERT_GT(scene.meshes.size(), 20u);
  const Expected expected =
      expected_of(PlainOracle(scene), scene, ray_budget(5000), Random(seed(), 900));
  for (const bool divides_space : {false, true}) {
    EXPECT_EQ(CompactScene(scene, divides_space).difference_of_all(expected), "")
        << "KIWAMI_SEED=" << seed();
  }
}

/// Kernels that took the vertices of another triangle would be noticed.
TEST(CompactTrees, AreCaughtWhereATriangleIsTakenForAnother) {
  const Scene scene = scene_of(closed_meshes().front());
  const CompactScene compact(scene, false);
  const Expected expected = expected_of(PlainOracle(scene), scene, 5000, Random(5));
  for (const NamedKernels& kernels : all_kernels(kiwami::LeafLayout::kIndices)) {
    kiwami::SceneView view = compact.view(kernels.width);
    EXPECT_EQ(difference(kernels, view, expected), "") << kernels.name;
    kiwami::TriangleMeshView shifted = view.meshes[0];
    shifted.indices += shifted.index_stride;
    shifted.triangle_count -= 1;
    std::vector<uint32_t> indices(3 * (size_t{shifted.triangle_count} + 2));
    std::memcpy(indices.data(), shifted.indices, 12 * size_t{shifted.triangle_count});
    shifted.indices = reinterpret_cast<const unsigned char*>(indices.data());
    shifted.index_stride = 12;
    view.meshes = &shifted;
    EXPECT_NE(difference(kernels, view, expected), "") << kernels.name;
  }
}

}  // namespace
}  // namespace kiwami_tests
