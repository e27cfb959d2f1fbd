// SPDX-License-Identifier: Apache-2.0
// Procedural scenes are what their names say.
#include "scene/procedural.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace kiwami::tools {
namespace {

double triangle_area(const Mesh& mesh, size_t first_index) {
  Vec3d corner[3];
  for (size_t i = 0; i < 3; ++i) {
    const float* v = &mesh.vertices[size_t{mesh.indices[first_index + i]} * 3];
    corner[i] = {v[0], v[1], v[2]};
  }
  return 0.5 * length(cross(corner[1] - corner[0], corner[2] - corner[0]));
}

/// Whether each edge is passed once in each direction.
bool is_closed(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> passes;
  for (size_t i = 0; i < mesh.indices.size(); i += 3) {
    for (size_t k = 0; k < 3; ++k) ++passes[{mesh.indices[i + k], mesh.indices[i + (k + 1) % 3]}];
  }
  return std::all_of(passes.begin(), passes.end(), [&](const auto& pass) {
    const auto opposite = passes.find({pass.first.second, pass.first.first});
    return pass.second == 1 && opposite != passes.end() && opposite->second == 1;
  });
}

TEST(Procedural, SphereIsClosedAndRoundAndFacesOutwards) {
  for (uint32_t level = 0; level <= 4; ++level) {
    const Mesh mesh = make_sphere(level);
    EXPECT_EQ(mesh.triangle_count(), 20u << (2 * level));
    EXPECT_TRUE(is_closed(mesh));
    for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
      EXPECT_NEAR(length(Vec3{mesh.vertices[i], mesh.vertices[i + 1], mesh.vertices[i + 2]}), 1.0f,
                  1e-6f);
    }
    double volume = 0;
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
      Vec3d corner[3];
      for (size_t k = 0; k < 3; ++k) {
        const float* v = &mesh.vertices[size_t{mesh.indices[i + k]} * 3];
        corner[k] = {v[0], v[1], v[2]};
      }
      volume += dot(corner[0], cross(corner[1], corner[2])) / 6.0;
    }
    EXPECT_GT(volume, 2.5);
    EXPECT_LT(volume, 4.19);
  }
}

TEST(Procedural, TerrainHasItsCells) {
  const Mesh mesh = make_terrain(7);
  EXPECT_EQ(mesh.triangle_count(), 2u * 7 * 7);
  EXPECT_EQ(mesh.vertex_count(), 8u * 8);
  for (size_t i = 0; i < mesh.indices.size(); i += 3) EXPECT_GT(triangle_area(mesh, i), 0.0);
}

TEST(Procedural, SoupDependsOnItsSeedAlone) {
  EXPECT_EQ(make_soup(50, 1).vertices, make_soup(50, 1).vertices);
  EXPECT_NE(make_soup(50, 1).vertices, make_soup(50, 2).vertices);
  EXPECT_EQ(make_soup(50, 1).triangle_count(), 50u);
}

TEST(Procedural, StadiumSpansManyDecadesOfArea) {
  const std::optional<SceneFile> scene = make_procedural_scene("stadium");
  ASSERT_TRUE(scene.has_value());
  EXPECT_GT(scene->triangle_count(), 100000u);
  EXPECT_TRUE(scene->view.has_value());
  double least = 1e300;
  double greatest = 0.0;
  for (const Mesh& mesh : scene->meshes) {
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
      const double area = triangle_area(mesh, i);
      least = std::min(least, area);
      greatest = std::max(greatest, area);
    }
  }
  EXPECT_GT(least, 0.0);
  EXPECT_GT(greatest / least, 1e8);
  EXPECT_EQ(scene->meshes[0].name, "teapot");
  EXPECT_TRUE(is_closed(scene->meshes[0]));
}

TEST(Procedural, HairballHasExactlyItsTrianglesAndTheyAreThin) {
  for (const uint64_t count : {1u, 39u, 40u, 41u, 1000u}) {
    const std::optional<SceneFile> scene =
        make_procedural_scene("hairball:" + std::to_string(count));
    ASSERT_TRUE(scene.has_value());
    EXPECT_EQ(scene->triangle_count(), count);
    const Mesh& mesh = scene->meshes[0];
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
      // The longest side of a triangle that is as thin is many times its area's root.
      EXPECT_GT(triangle_area(mesh, i), 0.0);
      EXPECT_LT(std::sqrt(triangle_area(mesh, i)), 0.2 * 0.045);
    }
  }
}

TEST(Procedural, RoomHasHundredsOfCopiesOfSeveralMeshesWithinItsWalls) {
  const std::optional<SceneFile> scene = make_procedural_scene("room:50000");
  ASSERT_TRUE(scene.has_value());
  EXPECT_GE(scene->triangle_count(), 50000u);
  EXPECT_LT(scene->triangle_count(), 75000u);
  EXPECT_GE(scene->meshes.size(), 5u);
  EXPECT_GE(scene->instances.size(), 200u);
  const SceneFile world = flatten(*scene);
  EXPECT_EQ(world.triangle_count(), scene->triangle_count());
  for (const Mesh& mesh : world.meshes) {
    for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
      const bool inside = mesh.vertices[i] >= 0 && mesh.vertices[i] <= 12 &&
                          mesh.vertices[i + 1] >= 0 && mesh.vertices[i + 1] <= 4 &&
                          mesh.vertices[i + 2] >= 0 && mesh.vertices[i + 2] <= 9;
      ASSERT_TRUE(inside) << mesh.name;
    }
  }
}

TEST(Procedural, ForestHasOverlappingTreesOnAFloor) {
  const std::optional<SceneFile> scene = make_procedural_scene("forest:50");
  ASSERT_TRUE(scene.has_value());
  EXPECT_EQ(scene->instances.size(), 51u);
  EXPECT_GT(scene->triangle_count(), 50u * 3000u);
  EXPECT_TRUE(scene->view.has_value());
  // The trunks stand closer than the crowns are wide.
  size_t overlapping = 0;
  for (const Instance& a : scene->instances) {
    for (const Instance& b : scene->instances) {
      const float x = a.transform[3] - b.transform[3], z = a.transform[11] - b.transform[11];
      overlapping += &a != &b && std::hypot(x, z) < 2.5f;
    }
  }
  EXPECT_GT(overlapping, 3 * scene->instances.size());
}

TEST(Procedural, LargeTerrainHasFourMillionTriangles) {
  const std::optional<SceneFile> scene = make_procedural_scene("terrain");
  ASSERT_TRUE(scene.has_value());
  EXPECT_NEAR(static_cast<double>(scene->triangle_count()), 4e6, 1e4);
  EXPECT_TRUE(scene->view.has_value());
}

TEST(Procedural, OtherNamesAreNoScenes) {
  for (const char* name : {"", "a.obj", "sphere", "C:file.tri", "stadium.obj", "cube:3"}) {
    EXPECT_FALSE(make_procedural_scene(name).has_value()) << name;
  }
}

TEST(Procedural, NumbersOutOfBoundsAreRefused) {
  for (const char* name :
       {"sphere:10",  "sphere:-1",      "sphere:1:2",   "sphere:1 ",
        "sphere:",    "terrain:0",      "terrain:4097", "soup:1",
        "soup:0:1",   "soup:1:",        "soup:1:2:3",   "soup:99999999999999999999:1",
        "hairball:0", "hairball:",      "hairball:5:5", "room:0",
        "room:-1",    "room:100000001", "forest:0",     "forest:1000001"}) {
    EXPECT_THROW(make_procedural_scene(name), SceneError) << name;
  }
}

}  // namespace
}  // namespace kiwami::tools
