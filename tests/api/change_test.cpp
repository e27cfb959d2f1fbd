// SPDX-License-Identifier: Apache-2.0
// Scenes whose geometries, masks and vertices change in any order: after every change the answers
// are those of a scene that was made anew.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <memory>

#include "api/changes.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::seed;

TEST(Change, DisabledGeometriesAreNotMet) {
  const Device device = make_device();
  const Scene scene = make_scene(device, make_mesh(device, square(1).desc()));
  uint32_t far = 0;
  ASSERT_EQ(kiwami_scene_attach(scene.get(), make_mesh(device, square(2).desc()).get(), &far),
            KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  const kiwami_ray ray = ray_along_z(0.5f, 0.25f);
  ASSERT_EQ(kiwami_scene_enable(scene.get(), 0, 0), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 0u);  // until the next commit
  for (const auto commit : {kiwami_scene_commit, kiwami_scene_refit}) {
    ASSERT_EQ(commit(scene.get()), KIWAMI_OK);
    EXPECT_EQ(closest_hit(scene, ray).geometry_id, far);
    EXPECT_EQ(info_of(scene).triangle_count, 2u);
  }
  // The number stays taken.
  uint32_t third = 0;
  ASSERT_EQ(kiwami_scene_attach(scene.get(), make_mesh(device, square(3).desc()).get(), &third),
            KIWAMI_OK);
  EXPECT_EQ(third, 2u);
  ASSERT_EQ(kiwami_scene_enable(scene.get(), 0, 7), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 0u);
  // Attached anew, a geometry is enabled.
  ASSERT_EQ(kiwami_scene_enable(scene.get(), 0, 0), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_detach(scene.get(), 0), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), make_mesh(device, square(1.5f).desc()).get(), &third),
            KIWAMI_OK);
  EXPECT_EQ(third, 0u);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).t, 1.5f);
}

TEST(Change, MasksAndOtherMeshesTakeEffectWithARefit) {
  const Device device = make_device();
  const Geometry near = make_mesh(device, square(1).desc());
  const Scene scene = make_scene(device, near);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), make_mesh(device, square(2).desc()).get(), nullptr),
            KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  kiwami_ray ray = ray_along_z(0.5f, 0.25f);
  ray.mask = 2;
  ASSERT_EQ(kiwami_geometry_set_mask(near.get(), 1), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).t, 1.0f);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).t, 2.0f);
  ASSERT_EQ(kiwami_geometry_set_mask(near.get(), ~0u), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).t, 1.0f);
  ASSERT_EQ(kiwami_scene_replace(scene.get(), 0, make_mesh(device, square(1.5f).desc()).get()),
            KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray).t, 1.0f);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 3u);
  EXPECT_EQ(closest_hit(scene, ray).t, 1.5f);
  EXPECT_EQ(closest_hit(scene, ray).geometry_id, 0u);
  // A mesh with another number of triangles has no place in the tree.
  ASSERT_EQ(
      kiwami_scene_replace(scene.get(), 0, make_mesh(device, random_triangles(50, 1).desc()).get()),
      KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(info_of(scene).refit_count, 0u);
  expect_valid(scene);
}

/// A scene of several meshes under changes, and what it should be.
class ChangingScene {
 public:
  ChangingScene(const Device& device, uint64_t number, bool is_two_level)
      : device_(device), random_(number, 3), scene_(make_scene(device)) {
    EXPECT_EQ(kiwami_scene_set_parameter(scene_.get(), KIWAMI_PARAMETER_TWO_LEVEL, is_two_level),
              KIWAMI_OK);
  }

  void change() {
    const uint32_t place = random_.below(kPlaces);
    Part& part = parts_[place];
    if (!part.mesh) {
      fill(part);
      uint32_t id = 0;
      EXPECT_EQ(kiwami_scene_attach(scene_.get(), part.mesh.get(), &id), KIWAMI_OK);
      if (id == place) return;
      // The lowest free number was another one.
      std::swap(parts_[id], part);
      return;
    }
    switch (random_.below(6)) {
      case 0:
        EXPECT_EQ(kiwami_scene_detach(scene_.get(), place), KIWAMI_OK);
        part = {};
        break;
      case 1:
        part.is_enabled = !part.is_enabled;
        EXPECT_EQ(kiwami_scene_enable(scene_.get(), place, part.is_enabled), KIWAMI_OK);
        break;
      case 2:
        part.mask = random_.bits();
        EXPECT_EQ(kiwami_geometry_set_mask(part.mesh.get(), part.mask), KIWAMI_OK);
        break;
      case 3: {
        const bool is_enabled = part.is_enabled;
        fill(part);
        part.is_enabled = is_enabled;
        EXPECT_EQ(kiwami_scene_replace(scene_.get(), place, part.mesh.get()), KIWAMI_OK);
        break;
      }
      default:
        move(part);
    }
  }

  kiwami_result commit() {
    return random_.one_in(3) ? kiwami_scene_commit(scene_.get()) : kiwami_scene_refit(scene_.get());
  }

  void expect_right(const std::vector<kiwami_ray>& rays) {
    const Scene fresh = make_scene(device_);
    for (uint32_t place = 0; place < kPlaces; ++place) {
      // A mesh of nothing keeps the numbers.
      kiwami_triangle_mesh_desc desc = default_mesh();
      if (parts_[place].mesh && parts_[place].is_enabled) {
        desc = parts_[place].triangles->desc();
        desc.mask = parts_[place].mask;
      }
      EXPECT_EQ(kiwami_scene_attach(fresh.get(), make_mesh(device_, desc).get(), nullptr),
                KIWAMI_OK);
    }
    EXPECT_EQ(kiwami_scene_commit(fresh.get()), KIWAMI_OK);
    expect_valid(scene_);
    EXPECT_EQ(info_of(scene_).triangle_count, info_of(fresh).triangle_count);
    EXPECT_TRUE(are_equal(closest_hits(scene_, rays), closest_hits(fresh, rays)));
  }

  const Scene& scene() const { return scene_; }

 private:
  static constexpr uint32_t kPlaces = 5;

  struct Part {
    std::unique_ptr<Triangles> triangles;  ///< at one address, for shared buffers
    Geometry mesh;
    bool is_enabled = true;
    uint32_t mask = ~0u;
  };

  void fill(Part& part) {
    auto triangles = std::make_unique<Triangles>(
        random_triangles(random_.one_in(5) ? 0 : 1 + random_.below(60), random_.bits()));
    kiwami_triangle_mesh_desc desc = triangles->desc();
    desc.flags = random_.one_in(2) ? KIWAMI_MESH_SHARE_BUFFERS : 0;
    Part filled;
    filled.mesh = make_mesh(device_, desc);
    filled.triangles = std::move(triangles);
    // The scene may still hold the old shared buffers.
    if (part.triangles) kept_.push_back(std::move(part.triangles));
    part = std::move(filled);
  }

  void move(Part& part) {
    std::vector<float>& vertices = part.triangles->vertices;
    const float distance = random_.one_in(2) ? 0.05f : 3.0f;
    const bool damages = random_.one_in(3);
    for (float& coordinate : vertices) {
      coordinate += distance * random_.symmetric();
      if (!std::isfinite(coordinate)) coordinate = random_.symmetric();
      if (damages && random_.one_in(10)) coordinate = NAN;
    }
    EXPECT_EQ(update(part.mesh, *part.triangles), KIWAMI_OK) << last_error();
  }

  const Device& device_;
  Random random_;
  Scene scene_;
  Part parts_[kPlaces];
  std::vector<std::unique_ptr<Triangles>> kept_;
};

class HostileSequences : public testing::TestWithParam<bool> {};

TEST_P(HostileSequences, GiveTheAnswersOfNewScenes) {
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed()));
  const Device device = make_device();
  const std::vector<kiwami_ray> rays = random_rays(300, seed());
  const size_t sequences = kiwami_tests::case_budget(40);
  for (size_t i = 0; i < sequences; ++i) {
    SCOPED_TRACE(i);
    ChangingScene changing(device, seed() + i, GetParam());
    Random random(seed() + i);
    for (int step = 0; step < 12; ++step) {
      for (uint32_t changes = random.below(4); changes != 0; --changes) changing.change();
      ASSERT_EQ(changing.commit(), KIWAMI_OK) << last_error();
      changing.expect_right(rays);
      if (testing::Test::HasFailure()) return;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Change, HostileSequences, testing::Values(false, true));

TEST(Change, BadArgumentsAreNamed) {
  const Device device = make_device();
  const Device other_device = make_device();
  const Triangles triangles = square(1);
  const Geometry mesh = make_mesh(device, triangles.desc());
  const Scene scene = make_scene(device, mesh);
  const float* vertices = triangles.vertices.data();
  const auto expect_error = [](kiwami_result result, const char* part) {
    EXPECT_EQ(result, KIWAMI_ERROR_INVALID_ARGUMENT) << part;
    EXPECT_NE(last_error().find(part), std::string::npos) << last_error();
  };
  expect_error(kiwami_triangle_mesh_update_vertices(nullptr, vertices, 0, 0), "geometry is NULL");
  expect_error(kiwami_triangle_mesh_update_vertices(mesh.get(), nullptr, 0, 0), "vertices is NULL");
  expect_error(kiwami_triangle_mesh_update_vertices(mesh.get(), vertices, 0, 11),
               "vertex_stride is 11");
  expect_error(kiwami_triangle_mesh_update_vertices(mesh.get(), vertices, ~uint64_t{0} - 20, 0),
               "reach beyond the address space");
  expect_error(kiwami_geometry_set_mask(nullptr, 0), "geometry is NULL");
  expect_error(kiwami_scene_refit(nullptr), "scene is NULL");
  expect_error(kiwami_scene_enable(nullptr, 0, 0), "scene is NULL");
  expect_error(kiwami_scene_enable(scene.get(), 1, 0), "geometry_id is 1");
  expect_error(kiwami_scene_replace(scene.get(), 1, mesh.get()), "geometry_id is 1");
  expect_error(kiwami_scene_replace(scene.get(), 0, nullptr), "geometry is NULL");
  expect_error(kiwami_scene_replace(nullptr, 0, mesh.get()), "scene is NULL");
  expect_error(
      kiwami_scene_replace(scene.get(), 0, make_mesh(other_device, triangles.desc()).get()),
      "geometry is of another device");
  // Nothing has changed.
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(closest_hit(scene, ray_along_z(0.5f, 0.25f)).t, 1.0f);
  // A mesh of no vertices has none to be read.
  const Geometry empty = make_mesh(device, default_mesh());
  EXPECT_EQ(kiwami_triangle_mesh_update_vertices(empty.get(), nullptr, 0, 0), KIWAMI_OK);
}

}  // namespace
}  // namespace kiwami_api_tests
