// SPDX-License-Identifier: Apache-2.0
#include "scene/forest.h"

#include <array>
#include <cmath>
#include <numbers>

#include "scene/random.h"

namespace kiwami::tools {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr uint32_t kKinds = 3;
constexpr uint32_t kTwigs = 260;
constexpr uint32_t kLeavesPerTwig = 6;
/// Crowns are about 5 wide: between neighbours most of them is common.
constexpr float kSpacing = 2.2f;
constexpr uint32_t kFloorCells = 64;

uint32_t push_vertex(Mesh& mesh, Vec3 v) {
  mesh.vertices.insert(mesh.vertices.end(), {v.x, v.y, v.z});
  return static_cast<uint32_t>(mesh.vertex_count()) - 1;
}

Vec3 random_in_ball(Random& random) {
  for (;;) {
    const float x = random.uniform(-1.0f, 1.0f);
    const float y = random.uniform(-1.0f, 1.0f);
    const float z = random.uniform(-1.0f, 1.0f);
    const Vec3 point{x, y, z};
    const float square = dot(point, point);
    if (square > 1e-4f && square <= 1.0f) return point;
  }
}

/// A branch from a to b: three sides, thinner at its end.
void add_branch(Mesh& mesh, Vec3 a, Vec3 b, float radius) {
  const Vec3 along = normalize(b - a);
  const Vec3 beside =
      normalize(cross(along, std::abs(along.y) < 0.9f ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
  const Vec3 across = cross(along, beside);
  uint32_t ring[2][3];
  for (uint32_t side = 0; side < 3; ++side) {
    const float angle = 2.0f * kPi * static_cast<float>(side) / 3.0f;
    const Vec3 out = beside * std::cos(angle) + across * std::sin(angle);
    ring[0][side] = push_vertex(mesh, a + out * radius);
    ring[1][side] = push_vertex(mesh, b + out * (0.4f * radius));
  }
  for (uint32_t side = 0; side < 3; ++side) {
    const uint32_t next = (side + 1) % 3;
    mesh.indices.insert(mesh.indices.end(), {ring[0][side], ring[0][next], ring[1][next],
                                             ring[0][side], ring[1][next], ring[1][side]});
  }
}

/// A leaf: a diamond of two triangles.
void add_leaf(Mesh& mesh, Vec3 stem, Random& random) {
  const Vec3 along = normalize(random_in_ball(random)) * random.uniform(0.12f, 0.25f);
  const Vec3 side = normalize(cross(along, random_in_ball(random))) * 0.06f;
  const uint32_t a = push_vertex(mesh, stem);
  const uint32_t b = push_vertex(mesh, stem + along * 0.5f + side);
  const uint32_t c = push_vertex(mesh, stem + along);
  const uint32_t d = push_vertex(mesh, stem + along * 0.5f - side);
  mesh.indices.insert(mesh.indices.end(), {a, b, c, a, c, d});
}

/// A tree of height 6 or so: a trunk, and twigs with leaves in an ellipsoid.
Mesh make_tree(uint32_t kind) {
  Random random(kind, 3);
  Mesh mesh;
  mesh.name = "tree " + std::to_string(kind);
  const Vec3 crown{2.4f - 0.3f * static_cast<float>(kind), 2.0f + 0.3f * static_cast<float>(kind),
                   2.4f - 0.2f * static_cast<float>(kind)};
  const Vec3 middle{0.0f, 4.0f, 0.0f};
  add_branch(mesh, {0, -0.5f, 0}, {0.1f, 4.5f, 0.05f}, 0.18f);
  for (uint32_t i = 0; i < kTwigs; ++i) {
    const Vec3 p = random_in_ball(random);
    const Vec3 end = middle + Vec3{p.x * crown.x, p.y * crown.y, p.z * crown.z};
    const Vec3 start = middle + (end - middle) * 0.7f;
    add_branch(mesh, start, end, 0.015f);
    for (uint32_t leaf = 0; leaf < kLeavesPerTwig; ++leaf) {
      add_leaf(mesh, start + (end - start) * random.uniform(0.2f, 1.1f), random);
    }
  }
  return mesh;
}

float floor_height(float x, float z) {
  return 0.6f * std::sin(0.13f * x) + 0.5f * std::cos(0.11f * z + 0.07f * x);
}

/// A square from -half to half.
Mesh make_floor(float half) {
  Mesh mesh;
  mesh.name = "floor";
  for (uint32_t j = 0; j <= kFloorCells; ++j) {
    for (uint32_t i = 0; i <= kFloorCells; ++i) {
      const float x = half * (2.0f * static_cast<float>(i) / kFloorCells - 1.0f);
      const float z = half * (2.0f * static_cast<float>(j) / kFloorCells - 1.0f);
      push_vertex(mesh, {x, floor_height(x, z), z});
    }
  }
  const uint32_t row = kFloorCells + 1;
  for (uint32_t j = 0; j < kFloorCells; ++j) {
    for (uint32_t i = 0; i < kFloorCells; ++i) {
      const uint32_t a = j * row + i;
      mesh.indices.insert(mesh.indices.end(), {a, a + row, a + row + 1, a, a + row + 1, a + 1});
    }
  }
  return mesh;
}

/// Turned around the vertical and leaning a little, scaled, and moved.
std::array<float, 12> placement(Random& random, Vec3 position) {
  const float turn = random.uniform(0.0f, 2.0f * kPi);
  const float lean = random.uniform(-0.12f, 0.12f);
  const float scale = random.uniform(0.7f, 1.2f);
  const float height = scale * random.uniform(0.85f, 1.2f);
  const float c = std::cos(turn), s = std::sin(turn);
  return {scale * c, height * lean, scale * s,  position.x, 0.0f,      height,
          0.0f,      position.y,    -scale * s, 0.0f,       scale * c, position.z};
}

}  // namespace

SceneFile make_forest(uint64_t tree_count) {
  SceneFile scene;
  for (uint32_t kind = 0; kind < kKinds; ++kind) scene.meshes.push_back(make_tree(kind));
  const float half = 0.5f * kSpacing * std::sqrt(static_cast<float>(tree_count));
  scene.meshes.push_back(make_floor(half + 3.0f));
  scene.instances.push_back({kKinds, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}});
  Random random(4);
  for (uint64_t i = 0; i < tree_count; ++i) {
    const float x = random.uniform(-half, half);
    const float z = random.uniform(-half, half);
    scene.instances.push_back(
        {random.below(kKinds), placement(random, {x, floor_height(x, z), z})});
  }
  const float away = half + 2.0f;
  scene.view =
      View{{away * 0.3f, 2.0f, away * 0.9f}, {0.0f, 3.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 60.0f};
  return scene;
}

}  // namespace kiwami::tools
