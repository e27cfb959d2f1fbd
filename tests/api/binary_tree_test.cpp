// SPDX-License-Identifier: Apache-2.0
// Binary trees in both layouts: the hits of a scene, to the bit, of every builder's tree.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "kiwami/binary_tree.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/environment.h"
#include "support/feature_rays.h"
#include "support/library.h"
#include "support/ray_generator.h"

namespace kiwami_tests {
namespace {

constexpr uint32_t kLayouts[] = {KIWAMI_BINARY_LAYOUT_BOXES, KIWAMI_BINARY_LAYOUT_DUAL_SPLIT};

struct ReleaseTree {
  void operator()(kiwami_binary_tree* tree) const { kiwami_binary_tree_release(tree); }
  void operator()(kiwami_bvh* bvh) const { kiwami_bvh_release(bvh); }
};
using TreeHandle = std::unique_ptr<kiwami_binary_tree, ReleaseTree>;
using BvhHandle = std::unique_ptr<kiwami_bvh, ReleaseTree>;
using GeometryHandle = std::unique_ptr<kiwami_geometry, Release>;

GeometryHandle make_geometry(const DeviceHandle& device, const Mesh& mesh) {
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertices.size();
  desc.indices = mesh.triangles.data();
  desc.triangle_count = mesh.triangles.size();
  desc.mask = mesh.mask;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_triangle_mesh_create(device.get(), &desc, &geometry));
  return GeometryHandle(geometry);
}

kiwami_bvh_desc describe(const GeometryHandle& geometry, uint32_t width) {
  kiwami_bvh_desc desc;
  check(kiwami_bvh_desc_init(&desc, sizeof desc));
  desc.geometry = geometry.get();
  desc.width = width;
  return desc;
}

BvhHandle build(const DeviceHandle& device, const kiwami_bvh_desc& desc) {
  kiwami_bvh* bvh = nullptr;
  check(kiwami_bvh_build(device.get(), &desc, &bvh));
  return BvhHandle(bvh);
}

BvhHandle build(const DeviceHandle& device, const GeometryHandle& geometry, uint32_t builder) {
  const kiwami_parameter_value parameter{KIWAMI_PARAMETER_BUILDER, 0, static_cast<double>(builder)};
  kiwami_bvh_desc desc = describe(geometry, 2);
  desc.parameters = &parameter;
  desc.parameter_count = 1;
  return build(device, desc);
}

TreeHandle make(const BvhHandle& bvh, uint32_t layout) {
  kiwami_binary_tree* tree = nullptr;
  check(kiwami_binary_tree_create(bvh.get(), layout, &tree));
  return TreeHandle(tree);
}

kiwami_binary_tree_info info_of(const TreeHandle& tree) {
  kiwami_binary_tree_info info;
  info.struct_size = sizeof info;
  check(kiwami_binary_tree_get_info(tree.get(), &info));
  return info;
}

std::vector<kiwami_hit> trace(const TreeHandle& tree, const std::vector<kiwami_ray>& rays,
                              kiwami_binary_visits* visits = nullptr) {
  std::vector<kiwami_hit> hits(rays.size());
  check(kiwami_binary_tree_closest_hit(tree.get(), rays.data(), 0, hits.data(), 0, rays.size(),
                                       visits));
  return hits;
}

void expect_equal(const std::vector<kiwami_hit>& hits, const std::vector<kiwami_hit>& expected,
                  const std::string& what) {
  for (size_t i = 0; i < hits.size(); ++i) {
    ASSERT_EQ(std::memcmp(&hits[i], &expected[i], sizeof hits[i]), 0)
        << what << ", ray " << i << ": t " << hits[i].t << ", expected " << expected[i].t;
  }
}

/// Both layouts of each builder's tree find what the scene finds.
void expect_hits_of_scene(const DeviceHandle& device, const Scene& scene,
                          const std::vector<kiwami_ray>& rays,
                          const std::vector<uint32_t>& builders) {
  const std::vector<kiwami_hit> expected =
      closest_hits(make_scene(device.get(), scene, BuildOptions{}).get(), rays);
  const GeometryHandle geometry = make_geometry(device, scene.meshes[0]);
  for (const uint32_t builder : builders) {
    const BvhHandle bvh = build(device, geometry, builder);
    for (const uint32_t layout : kLayouts) {
      const std::string what = scene.name + ", builder " + std::to_string(builder) + ", layout " +
                               std::to_string(layout);
      const TreeHandle tree = make(bvh, layout);
      EXPECT_NO_THROW(check(kiwami_binary_tree_validate(tree.get()))) << what;
      expect_equal(trace(tree, rays), expected, what);
    }
  }
}

TEST(BinaryTree, HitsOfClosedMeshesAreThoseOfScenes) {
  RecordProperty("seed", std::to_string(seed()));
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 2);
  for (const ClosedMesh& closed : closed_meshes()) {
    FeatureRayGenerator features(closed, Random(seed(), 720));
    std::vector<kiwami_ray> rays;
    for (uint64_t i = 0; i < ray_budget(1500); ++i) {
      rays.push_back(features.line());
      rays.push_back(features.inside_ray());
    }
    expect_hits_of_scene(device, scene_of(closed), rays,
                         {KIWAMI_BUILDER_BINNED_SAH, KIWAMI_BUILDER_LBVH, KIWAMI_BUILDER_OIBVH,
                          KIWAMI_BUILDER_SPATIAL_SPLIT});
  }
}

TEST(BinaryTree, HitsOfAdversarialScenesAreThoseOfScenes) {
  RecordProperty("seed", std::to_string(seed()));
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  for (uint32_t index = 0; index < case_budget(60); ++index) {
    Scene scene = adversarial_scene(index, seed());
    if (scene.meshes.empty()) continue;
    scene.meshes.resize(1);
    RayGenerator generator(scene, Random(seed(), 721 + index));
    std::vector<kiwami_ray> rays(ray_budget(300));
    for (kiwami_ray& ray : rays) ray = generator.next();
    expect_hits_of_scene(device, scene, rays, {KIWAMI_BUILDER_BINNED_SAH, KIWAMI_BUILDER_PLOC});
  }
}

TEST(BinaryTree, DualSplitIsSmallerAndComparesFewerPlanes) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const ClosedMesh closed = closed_meshes()[0];
  const BvhHandle bvh =
      build(device, make_geometry(device, closed.mesh), KIWAMI_BUILDER_BINNED_SAH);
  FeatureRayGenerator features(closed, Random(seed(), 722));
  std::vector<kiwami_ray> rays(6000);  // enough for several threads
  for (kiwami_ray& ray : rays) ray = features.line();
  kiwami_binary_visits visits[2];
  kiwami_binary_tree_info infos[2];
  for (const uint32_t layout : kLayouts) {
    const TreeHandle tree = make(bvh, layout);
    visits[layout].struct_size = sizeof visits[layout];
    trace(tree, rays, &visits[layout]);
    infos[layout] = info_of(tree);
    EXPECT_EQ(infos[layout].layout, layout);
    EXPECT_EQ(infos[layout].primitive_count, closed.mesh.triangles.size());
    EXPECT_EQ(infos[layout].node_count,
              infos[layout].split_count + infos[layout].carve_count + infos[layout].leaf_count);
    EXPECT_EQ(infos[layout].node_bytes, infos[layout].node_count * (layout == 0 ? 32 : 12));
    EXPECT_GT(visits[layout].node_visits, rays.size());
    EXPECT_GT(visits[layout].leaf_visits, 0u);
  }
  EXPECT_EQ(infos[0].carve_count, 0u);
  EXPECT_EQ(infos[0].split_count, infos[1].split_count);
  EXPECT_EQ(infos[0].leaf_count, infos[1].leaf_count);
  EXPECT_LT(infos[1].node_bytes, infos[0].node_bytes * 3 / 5);
  EXPECT_LT(visits[1].plane_tests, visits[0].plane_tests / 2);
  // The sums do not depend on threads.
  const DeviceHandle many = make_device(KIWAMI_ISA_AUTO, 3);
  const TreeHandle tree =
      make(build(many, make_geometry(many, closed.mesh), KIWAMI_BUILDER_BINNED_SAH), 1);
  kiwami_binary_visits again;
  again.struct_size = sizeof again;
  trace(tree, rays, &again);
  EXPECT_EQ(again.plane_tests, visits[1].plane_tests);
  EXPECT_EQ(again.leaf_visits, visits[1].leaf_visits);
}

TEST(BinaryTree, OutlivesWhatItWasMadeOf) {
  DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  Mesh mesh;
  mesh.add({0, 0, 1}, {1, 0, 1}, {0, 1, 1});
  mesh.add({0, 0, 2}, {1, 0, 2}, {0, 1, 2});
  GeometryHandle geometry = make_geometry(device, mesh);
  BvhHandle bvh = build(device, geometry, KIWAMI_BUILDER_BINNED_SAH);
  for (const uint32_t layout : kLayouts) {
    const TreeHandle tree = make(bvh, layout);
    kiwami_binary_tree_retain(tree.get());
    kiwami_binary_tree_release(tree.get());
    const std::vector<Point> moved(6, Point{9, 9, 9});
    check(kiwami_triangle_mesh_update_vertices(geometry.get(), moved.data(), 0, 0));
    const kiwami_hit hit = trace(tree, {ray_from({0.2f, 0.2f, 0}, {0, 0, 1})})[0];
    EXPECT_EQ(hit.t, 1.0f);
    EXPECT_EQ(hit.primitive_id, 0u);
    EXPECT_EQ(hit.geometry_id, 0u);
    std::vector<Point> back = mesh.vertices;
    check(kiwami_triangle_mesh_update_vertices(geometry.get(), back.data(), 0, 0));
  }
  const TreeHandle tree = make(bvh, KIWAMI_BINARY_LAYOUT_DUAL_SPLIT);
  bvh.reset();
  geometry.reset();
  device.reset();
  EXPECT_EQ(trace(tree, {ray_from({0.2f, 0.2f, 3}, {0, 0, -1})})[0].primitive_id, 1u);
}

void expect_error(kiwami_result result, const char* part) {
  EXPECT_EQ(result, KIWAMI_ERROR_INVALID_ARGUMENT) << part;
  char sentence[512];
  kiwami_last_error(nullptr, sentence, sizeof sentence);
  EXPECT_NE(std::strstr(sentence, part), nullptr) << sentence;
}

TEST(BinaryTree, OtherTreesAreRefused) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const ClosedMesh closed = closed_meshes()[0];
  const GeometryHandle geometry = make_geometry(device, closed.mesh);
  kiwami_binary_tree* tree = nullptr;
  const auto create = [&](const BvhHandle& bvh, uint32_t layout) {
    const kiwami_result result = kiwami_binary_tree_create(bvh.get(), layout, &tree);
    EXPECT_EQ(tree, nullptr);
    return result;
  };
  expect_error(create(build(device, describe(geometry, 4)), 0), "bvh has the width 4");
  const float box[6] = {0, 0, 0, 1, 1, 1};
  kiwami_bvh_desc boxes;
  check(kiwami_bvh_desc_init(&boxes, sizeof boxes));
  boxes.width = 2;
  boxes.boxes = box;
  boxes.box_count = 1;
  expect_error(create(build(device, boxes), 0), "over boxes");
  const kiwami_parameter_value leaf_size{KIWAMI_PARAMETER_MAX_LEAF_SIZE, 0, 8.0};
  kiwami_bvh_desc large = describe(geometry, 2);
  large.parameters = &leaf_size;
  large.parameter_count = 1;
  expect_error(create(build(device, large), 0), "8 triangles a leaf");
  const BvhHandle good = build(device, describe(geometry, 2));
  expect_error(create(good, 2), "layout is 2");
  expect_error(create(BvhHandle(), 0), "bvh is NULL");
  expect_error(kiwami_binary_tree_create(good.get(), 0, nullptr), "tree is NULL");
  expect_error(kiwami_binary_tree_validate(nullptr), "tree is NULL");
  expect_error(kiwami_binary_tree_get_info(nullptr, nullptr), "tree is NULL");
  expect_error(kiwami_binary_tree_closest_hit(nullptr, nullptr, 0, nullptr, 0, 0, nullptr),
               "tree is NULL");
  kiwami_binary_visits visits{};
  expect_error(
      kiwami_binary_tree_closest_hit(make(good, 1).get(), nullptr, 0, nullptr, 0, 0, &visits),
      "visits.struct_size");
  kiwami_binary_tree_retain(nullptr);
  kiwami_binary_tree_release(nullptr);
}

}  // namespace
}  // namespace kiwami_tests
