// SPDX-License-Identifier: Apache-2.0
// Instances of a square through the C interface, for several files of tests.
#pragma once

#include <gtest/gtest.h>

#include <array>

#include "api/api_support.h"

namespace kiwami_api_tests {

using Matrix = std::array<float, 12>;

constexpr Matrix kIdentity = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};

inline Matrix translation(float x, float y, float z) {
  return {1, 0, 0, x, 0, 1, 0, y, 0, 0, 1, z};
}
inline Matrix scaling(float x, float y, float z) { return {x, 0, 0, 0, 0, y, 0, 0, 0, 0, z, 0}; }

inline kiwami_instances_desc default_instances() {
  kiwami_instances_desc desc;
  EXPECT_EQ(kiwami_instances_desc_init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

/// Instances of some scenes.
struct Group {
  std::vector<kiwami_scene*> scenes;
  std::vector<uint32_t> indices;  ///< empty: all of the first scene
  std::vector<Matrix> transforms;
  std::vector<uint32_t> masks;  ///< empty: all ones

  kiwami_instances_desc desc() const {
    kiwami_instances_desc desc = default_instances();
    desc.scenes = scenes.data();
    desc.scene_count = scenes.size();
    desc.scene_indices = indices.empty() ? nullptr : indices.data();
    desc.transforms = transforms.data();
    desc.count = transforms.size();
    desc.masks = masks.empty() ? nullptr : masks.data();
    return desc;
  }
};

class Instances : public testing::Test {
 protected:
  Geometry make(const kiwami_instances_desc& desc) {
    kiwami_geometry* geometry = nullptr;
    EXPECT_EQ(kiwami_instances_create(device_.get(), &desc, &geometry), KIWAMI_OK) << last_error();
    return Geometry(geometry);
  }
  Geometry make(const Group& group) { return make(group.desc()); }

  /// A committed scene of one array of instances.
  Scene scene_of(const Group& group) { return make_scene(device_, make(group)); }

  void expect_refused(const kiwami_instances_desc& desc, const std::string& sentence,
                      kiwami_result result = KIWAMI_ERROR_INVALID_ARGUMENT) {
    kiwami_geometry* geometry = reinterpret_cast<kiwami_geometry*>(&device_);
    EXPECT_EQ(kiwami_instances_create(device_.get(), &desc, &geometry), result);
    EXPECT_EQ(geometry, nullptr);
    EXPECT_EQ(last_error(device_.get()), sentence);
  }

  void expect_commit_fails(const Scene& scene, kiwami_result result, const std::string& sentence) {
    EXPECT_EQ(kiwami_scene_commit(scene.get()), result);
    EXPECT_EQ(last_error(device_.get()), sentence);
  }

  Device device_ = make_device();
  Triangles square_ = square(0.0f);
  Geometry mesh_ = make_mesh(device_, square_.desc());
  Scene child_ = make_scene(device_, mesh_);  ///< the square -1 <= x, y <= 1 at z = 0
};

/// The closest hit of one ray and its path.
struct PathHit {
  kiwami_hit hit;
  std::array<uint32_t, KIWAMI_MAX_INSTANCE_DEPTH> path;
};

inline PathHit trace(const Scene& scene, const kiwami_ray& ray) {
  PathHit answer;
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.instance_paths = answer.path.data();
  EXPECT_EQ(kiwami_closest_hit(scene.get(), &ray, 0, &answer.hit, 0, 1, &query), KIWAMI_OK);
  return answer;
}

/// Along +z from z = -10.
inline kiwami_ray ray_at(float x, float y) {
  kiwami_ray ray = ray_along_z(x, y);
  ray.origin_z = -10.0f;
  return ray;
}

}  // namespace kiwami_api_tests
