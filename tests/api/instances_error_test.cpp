// SPDX-License-Identifier: Apache-2.0
// Instances through the C interface: what is refused, and in which words.
#include <cmath>

#include "api/instances_support.h"

namespace kiwami_api_tests {
namespace {

TEST_F(Instances, AreNoMeshesToBuildATreeOver) {
  const Geometry geometry = make({{child_.get()}, {}, {kIdentity}, {}});
  kiwami_bvh_desc desc;
  kiwami_bvh_desc_init(&desc, sizeof desc);
  desc.geometry = geometry.get();
  kiwami_bvh* bvh = nullptr;
  EXPECT_EQ(kiwami_bvh_build(device_.get(), &desc, &bvh), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), "desc.geometry is no triangle mesh, expected one, or boxes");
}

TEST_F(Instances, DescriptionsAreChecked) {
  const Group group{{child_.get()}, {0, 0}, {kIdentity, kIdentity}, {1, 1}};
  const auto with = [&](auto change) {
    kiwami_instances_desc desc = group.desc();
    change(desc);
    return desc;
  };
  expect_refused(with([](auto& d) { d.flags = 2; }),
                 "desc.flags is 0x2, expected KIWAMI_INSTANCES_* bits");
  expect_refused(with([](auto& d) { d.reserved = 1; }), "desc.reserved is 1, expected 0");
  expect_refused(with([](auto& d) { d.scenes = nullptr; }),
                 "desc.scenes is NULL, expected the scenes");
  expect_refused(with([](auto& d) { d.transforms = nullptr; }),
                 "desc.transforms is NULL, expected the matrices");
  expect_refused(with([](auto& d) { d.scene_count = 0; }),
                 "desc.scene_count is 0, expected at least 1");
  expect_refused(with([](auto& d) { d.count = 0; }), "desc.count is 0, expected at least 1");
  expect_refused(with([](auto& d) { d.count = uint64_t{1} << 31; }),
                 "desc.count is 2147483648, expected at most 2147483647", KIWAMI_ERROR_TOO_LARGE);
  expect_refused(with([](auto& d) { d.transform_stride = 47; }),
                 "desc.transform_stride is 47, expected at least 48, or 0 for 48");
  expect_refused(with([](auto& d) { d.scene_index_stride = 3; }),
                 "desc.scene_index_stride is 3, expected at least 4, or 0 for 4");
  expect_refused(with([](auto& d) { d.mask_stride = 2; }),
                 "desc.mask_stride is 2, expected at least 4, or 0 for 4");
  kiwami_scene* const none[] = {nullptr};
  expect_refused(with([&](auto& d) { d.scenes = none; }),
                 "desc.scenes[0] is NULL, expected a scene");
  const Device other = make_device();
  const Scene foreign = make_scene(other);
  kiwami_scene* const foreigners[] = {foreign.get()};
  expect_refused(with([&](auto& d) { d.scenes = foreigners; }),
                 "desc.scenes[0] is of another device, expected one of device");
  const uint32_t indices[] = {0, 1};
  expect_refused(with([&](auto& d) { d.scene_indices = indices; }),
                 "the scene index of instance 1 is 1, expected less than desc.scene_count, which "
                 "is 1");
  kiwami_geometry* geometry = nullptr;
  const kiwami_instances_desc desc = group.desc();
  EXPECT_EQ(kiwami_instances_create(nullptr, &desc, &geometry), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_instances_create(device_.get(), nullptr, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(kiwami_instances_create(device_.get(), &desc, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
}

TEST_F(Instances, SingularMatricesAreNamed) {
  const float nan = std::nanf("");
  const Matrix singular[] = {
      scaling(1, 1, 0),
      Matrix{},
      {1, 2, 3, 0, 2, 4, 6, 0, 0, 0, 1, 0},
      scaling(1, 1, 1e-8f),
      scaling(1, nan, 1),
      translation(0, kInfinity, 0),
      scaling(1e-30f, 1e-30f, 1e-30f),
      scaling(1e30f, 1e30f, 1e30f),
  };
  for (const Matrix& matrix : singular) {
    std::vector<Matrix> transforms(5000, kIdentity);
    transforms[4321] = transforms[4322] = matrix;
    const Group group{{child_.get()}, {}, transforms, {}};
    expect_refused(group.desc(),
                   "the transform of instance 4321 is singular or not finite, expected a condition "
                   "number of at most 2^20 and scales from 2^-60 to 2^60");
  }
}

TEST_F(Instances, CyclesAreRefusedWhereTheyWouldClose) {
  const Scene a = make_scene(device_, mesh_), b = make_scene(device_, mesh_);
  const Geometry shows_a = make({{a.get()}, {}, {kIdentity}, {}});
  const Geometry shows_b = make({{b.get()}, {}, {kIdentity}, {}});
  const std::string sentence =
      "geometry shows the scene that it is attached to, expected no cycle of instances";
  EXPECT_EQ(kiwami_scene_attach(a.get(), shows_a.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), sentence);
  ASSERT_EQ(kiwami_scene_attach(a.get(), shows_b.get(), nullptr), KIWAMI_OK);
  EXPECT_EQ(kiwami_scene_attach(b.get(), shows_a.get(), nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), sentence);
  EXPECT_EQ(kiwami_scene_replace(a.get(), 0, shows_a.get()), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), sentence);
  EXPECT_EQ(kiwami_scene_replace(b.get(), 0, shows_a.get()), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(device_.get()), sentence);
  EXPECT_EQ(kiwami_scene_commit(a.get()), KIWAMI_OK);
}

TEST_F(Instances, ScenesMustFitTheOuterOne) {
  const Scene uncommitted = make_scene(device_);
  const Geometry shows_uncommitted = make({{uncommitted.get()}, {}, {kIdentity}, {}});
  Scene scene = make_scene(device_);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), shows_uncommitted.get(), nullptr), KIWAMI_OK);
  expect_commit_fails(scene, KIWAMI_ERROR_INVALID_STATE,
                      "scene 0 of geometry 0 was never committed, expected a successful "
                      "kiwami_scene_commit before");
  ASSERT_EQ(kiwami_scene_set_parameter(child_.get(), KIWAMI_PARAMETER_BVH_WIDTH, 16), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(child_.get()), KIWAMI_OK);
  const Geometry shows_child = make({{child_.get()}, {}, {kIdentity}, {}});
  scene = make_scene(device_);
  ASSERT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, 4), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), shows_child.get(), nullptr), KIWAMI_OK);
  expect_commit_fails(scene, KIWAMI_ERROR_INVALID_ARGUMENT,
                      "scene 0 of geometry 0 has 16 children a node, expected 4 as the scene that "
                      "instances it");
}

}  // namespace
}  // namespace kiwami_api_tests
