// SPDX-License-Identifier: Apache-2.0
// KIWAMI_PARAMETER_LAYOUT: the same tree and the same answers in less memory.
#include <gtest/gtest.h>

#include <cstring>

#include "api/api_support.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

/// A wavy square of 2 n^2 triangles that share their vertices.
Triangles wavy_square(uint32_t n) {
  Triangles grid;
  for (uint32_t y = 0; y <= n; ++y) {
    for (uint32_t x = 0; x <= n; ++x) {
      const float u = static_cast<float>(x) / static_cast<float>(n);
      const float v = static_cast<float>(y) / static_cast<float>(n);
      grid.vertices.insert(grid.vertices.end(), {2 * u - 1, 2 * v - 1, u * (1 - u) * v});
    }
  }
  for (uint32_t y = 0; y < n; ++y) {
    for (uint32_t x = 0; x < n; ++x) {
      const uint32_t corner = y * (n + 1) + x, above = corner + n + 1;
      grid.indices.insert(grid.indices.end(),
                          {corner, corner + 1, above, corner + 1, above + 1, above});
    }
  }
  return grid;
}

/// Several meshes, with and without indices, one of no triangles, with gaps in the numbers.
class Layouts : public testing::Test {
 protected:
  Scene scene_of(uint32_t width, double layout) const {
    Scene scene = make_scene(device_);
    kiwami_triangle_mesh_desc unindexed = first_.desc();
    unindexed.indices = nullptr;
    kiwami_triangle_mesh_desc empty = first_.desc();
    empty.triangle_count = 0;
    kiwami_triangle_mesh_desc masked = second_.desc();
    masked.mask = 2;
    for (const auto& desc : {unindexed, empty, masked, grid_.desc()}) {
      const Geometry mesh = make_mesh(device_, desc);
      EXPECT_EQ(kiwami_scene_attach(scene.get(), mesh.get(), nullptr), KIWAMI_OK);
    }
    set(scene, KIWAMI_PARAMETER_BVH_WIDTH, width);
    set(scene, KIWAMI_PARAMETER_LAYOUT, layout);
    set(scene, KIWAMI_PARAMETER_VALIDATE_BUILD, 1);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  }

  static void set(const Scene& scene, uint32_t parameter, double value) {
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), parameter, value), KIWAMI_OK);
  }

  const Triangles first_ = random_triangles(900, kiwami_tests::seed());
  const Triangles second_ = random_triangles(700, kiwami_tests::seed() + 1);
  const Triangles grid_ = wavy_square(30);
  const Device device_ = make_device();
  const std::vector<kiwami_ray> rays_ = random_rays(5000, kiwami_tests::seed());
};

TEST_F(Layouts, GiveTheSameTreeAndTheSameAnswers) {
  for (const uint32_t width : {4u, 8u, 16u}) {
    SCOPED_TRACE(width);
    const Scene fast = scene_of(width, KIWAMI_LAYOUT_FAST);
    const Scene compact = scene_of(width, KIWAMI_LAYOUT_COMPACT);
    EXPECT_EQ(kiwami_scene_validate(compact.get()), KIWAMI_OK) << last_error();
    const kiwami_scene_info a = info_of(fast), b = info_of(compact);
    EXPECT_EQ(a.node_count, b.node_count);
    EXPECT_EQ(a.leaf_block_count, b.leaf_block_count);
    EXPECT_EQ(a.sah_cost, b.sah_cost);
    EXPECT_EQ(b.leaf_bytes, b.leaf_block_count * width * 4);
    EXPECT_EQ(a.leaf_bytes, 10 * b.leaf_bytes);
    EXPECT_EQ(a.total_bytes - b.total_bytes, a.leaf_bytes - b.leaf_bytes);
    const auto nodes = nodes_of(bvh_of(fast)), others = nodes_of(bvh_of(compact));
    ASSERT_EQ(nodes.size(), others.size());
    EXPECT_EQ(std::memcmp(nodes.data(), others.data(), nodes.size() * sizeof nodes[0]), 0);

    EXPECT_TRUE(are_equal(closest_hits(fast, rays_), closest_hits(compact, rays_)));
    std::vector<uint8_t> any[2];
    std::vector<uint32_t> counts[2];
    std::vector<kiwami_hit> lists[2];
    std::vector<uint64_t> offsets[2];
    kiwami_visits visits[2]{};
    for (const Scene* scene : {&fast, &compact}) {
      const size_t i = scene == &fast ? 0 : 1;
      any[i].resize(rays_.size());
      EXPECT_EQ(
          kiwami_any_hit(scene->get(), rays_.data(), 0, any[i].data(), 0, rays_.size(), nullptr),
          KIWAMI_OK);
      counts[i].resize(rays_.size());
      EXPECT_EQ(kiwami_count_hits(scene->get(), rays_.data(), 0, counts[i].data(), 0, rays_.size(),
                                  nullptr),
                KIWAMI_OK);
      offsets[i].resize(rays_.size() + 1);
      lists[i].resize(8 * rays_.size());
      EXPECT_EQ(kiwami_multi_hit(scene->get(), rays_.data(), 0, rays_.size(), 8, lists[i].data(),
                                 lists[i].size(), offsets[i].data(), nullptr),
                KIWAMI_OK)
          << last_error();
      lists[i].resize(offsets[i].back());
      visits[i].struct_size = sizeof visits[i];
      EXPECT_EQ(kiwami_scene_count_visits(scene->get(), rays_.data(), 0, rays_.size(),
                                          KIWAMI_COUNT_CLOSEST_HIT, &visits[i], nullptr, 0),
                KIWAMI_OK);
    }
    EXPECT_EQ(any[0], any[1]);
    EXPECT_EQ(counts[0], counts[1]);
    EXPECT_EQ(offsets[0], offsets[1]);
    EXPECT_TRUE(are_equal(lists[0], lists[1]));
    EXPECT_GT(lists[0].size(), rays_.size());
    EXPECT_EQ(visits[0].node_visits, visits[1].node_visits);
    EXPECT_EQ(visits[0].leaf_visits, visits[1].leaf_visits);
  }
}

TEST_F(Layouts, OfManyTrianglesTakeAtMost32BytesATriangle) {
  const Triangles grid = wavy_square(200);
  const Scene scene = make_scene(device_, make_mesh(device_, grid.desc()));
  // The default where there are vector kernels; nodes of 4 take 3 bytes a triangle more.
  set(scene, KIWAMI_PARAMETER_BVH_WIDTH, 8);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  const kiwami_scene_info fast = info_of(scene);
  set(scene, KIWAMI_PARAMETER_LAYOUT, KIWAMI_LAYOUT_COMPACT);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  const kiwami_scene_info compact = info_of(scene);
  const auto per_triangle = [](const kiwami_scene_info& info) {
    return static_cast<double>(info.total_bytes) / static_cast<double>(info.triangle_count);
  };
  std::printf("copied buffers included: %.1f bytes a triangle, compact %.1f\n", per_triangle(fast),
              per_triangle(compact));
  EXPECT_LE(per_triangle(compact), 32.0);
  EXPECT_GE(per_triangle(fast), 60.0);
}

TEST_F(Layouts, AreChosenByTheirNumbersAlone) {
  const Scene scene = make_scene(device_);
  for (const double value : {-1.0, 0.5, 2.0}) {
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_LAYOUT, value),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_NE(last_error().find("parameter 21, expected"), std::string::npos) << last_error();
  }
}

}  // namespace
}  // namespace kiwami_api_tests
