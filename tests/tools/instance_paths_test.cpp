// SPDX-License-Identifier: Apache-2.0
// Normals of hits in the instances of saved scenes, nested and moving: those of the surface that rays
// beside them meet.
#include "measure/instance_paths.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <filesystem>

#include "measure/library.h"
#include "measure/ray_sets.h"
#include "scene/kiwami_reader.h"
#include "support/rich_scene.h"

namespace kiwami::tools {
namespace {

constexpr float kStep = 1e-3f;

struct SceneRelease {
  void operator()(kiwami_scene* scene) const { kiwami_scene_release(scene); }
};

class InstancePathsTest : public testing::Test {
 protected:
  ~InstancePathsTest() override { std::filesystem::remove(path_); }

  void save(uint32_t parts) {
    kiwami_scene* made = nullptr;
    ASSERT_EQ(kiwami_tests::make_rich_scene(device_.get(), {parts, 8, 60}, &made), KIWAMI_OK);
    const std::unique_ptr<kiwami_scene, SceneRelease> scene(made);
    kiwami_save_desc desc;
    ASSERT_EQ(kiwami_save_desc_init(&desc, sizeof desc), KIWAMI_OK);
    desc.path = path_.c_str();
    ASSERT_EQ(kiwami_scene_save(made, &desc, nullptr), KIWAMI_OK);
  }

  const Device device_{KIWAMI_ISA_AUTO, 1};
  const std::string path_ = testing::TempDir() + "instance_paths_test.kiwami";
};

Vec3 point_of(const kiwami_ray& ray, const kiwami_hit& hit) {
  return Vec3{ray.origin_x, ray.origin_y, ray.origin_z} +
         Vec3{ray.direction_x, ray.direction_y, ray.direction_z} * hit.t;
}

/// Each ray, and two beside it.
std::vector<kiwami_ray> make_rays(size_t count) {
  const Box box{{-1.2f, -1.2f, -1.2f}, {1.2f, 1.2f, 1.2f}};
  std::vector<kiwami_ray> rays;
  Random random(5, 1);
  for (kiwami_ray ray : random_rays(box, count, 5).rays) {
    ray.flags = 0;
    ray.time = random.uniform();
    const Vec3 direction{ray.direction_x, ray.direction_y, ray.direction_z};
    const Vec3 aside =
        normalize(cross(direction, std::fabs(direction.x) > 0.7f ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
    for (const Vec3 step : {Vec3{0, 0, 0}, aside, normalize(cross(direction, aside))}) {
      rays.push_back(ray);
      rays.back().origin_x += kStep * step.x;
      rays.back().origin_y += kStep * step.y;
      rays.back().origin_z += kStep * step.z;
    }
  }
  return rays;
}

TEST_F(InstancePathsTest, CarryNormalsIntoTheWorld) {
  using namespace kiwami_tests;
  for (const uint32_t parts :
       {uint32_t{kRichInstances}, uint32_t{kRichMovingInstances},
        kRichInstances | kRichMovingInstances | kRichMotion | kRichRebraided}) {
    SCOPED_TRACE(parts);
    save(parts);
    const SceneFile file = read_saved_scene(path_);
    const BuiltScene scene(device_, path_, 0, &file);
    const std::vector<kiwami_ray> rays = make_rays(12000);
    std::vector<kiwami_hit> hits(rays.size()), own(rays.size());
    scene.closest_hits(rays, hits);
    scene.own_closest_hits(rays, own);
    size_t checked = 0, wrong = 0;
    for (size_t i = 0; i < rays.size(); i += 3) {
      if (own[i].instance_id == KIWAMI_INVALID_ID) continue;
      EXPECT_EQ(hits[i].geometry_id, own[i].instance_id);
      EXPECT_EQ(hits[i].instance_id, KIWAMI_INVALID_ID);
      const auto is_same = [&](size_t k) {
        return own[k].primitive_id == own[i].primitive_id &&
               own[k].geometry_id == own[i].geometry_id && own[k].instance_id == own[i].instance_id;
      };
      if (!is_same(i + 1) || !is_same(i + 2)) continue;
      const Vec3 point = point_of(rays[i], own[i]);
      const Vec3 plane = cross(point_of(rays[i + 1], own[i + 1]) - point,
                               point_of(rays[i + 2], own[i + 2]) - point);
      const Vec3 normal{hits[i].normal_x, hits[i].normal_y, hits[i].normal_z};
      // Seen from the side, or of another instance within the same, it says nothing.
      if (length(plane) > 20.0f * kStep * kStep) continue;
      ++checked;
      if (std::fabs(dot(normalize(plane), normalize(normal))) < 0.99f) ++wrong;
    }
    EXPECT_GT(checked, 200u);
    EXPECT_LE(50 * wrong, checked);
  }
}

}  // namespace
}  // namespace kiwami::tools
