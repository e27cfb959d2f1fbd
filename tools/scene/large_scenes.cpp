// SPDX-License-Identifier: Apache-2.0
#include "scene/large_scenes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

#include "scene/random.h"

namespace kiwami::tools {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

// A hairball's strands.
constexpr uint64_t kTrianglesPerStrand = 40;
constexpr float kStrandStep = 0.045f;
constexpr float kStrandHalfWidth = 0.0006f;
constexpr float kStrandCurl = 0.35f;

// A room's copies; each of its meshes is a grid of quads bent to a surface.
constexpr uint32_t kCopies = 240;
constexpr Vec3 kRoomSize = {12.0f, 4.0f, 9.0f};

void push_vertex(Mesh& mesh, Vec3 v) { mesh.vertices.insert(mesh.vertices.end(), {v.x, v.y, v.z}); }

/// A point of the unit ball.
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

/// One ribbon of `triangle_count` triangles, which turns a little at each step.
void grow_strand(Mesh& mesh, Random& random, uint64_t triangle_count) {
  Vec3 direction = normalize(random_in_ball(random));
  Vec3 point = direction * 0.1f;
  const Vec3 side = normalize(cross(direction, random_in_ball(random)));
  const auto first = static_cast<uint32_t>(mesh.vertex_count());
  push_vertex(mesh, point - side * kStrandHalfWidth);
  push_vertex(mesh, point + side * kStrandHalfWidth);
  for (uint64_t i = 0; i < triangle_count; ++i) {
    const auto corner = first + static_cast<uint32_t>(i);
    const bool starts_quad = i % 2 == 0;
    if (starts_quad) {
      direction = normalize(direction + random_in_ball(random) * kStrandCurl);
      point = point + direction * kStrandStep;
    }
    push_vertex(mesh, point + side * (starts_quad ? -kStrandHalfWidth : kStrandHalfWidth));
    if (starts_quad) {
      mesh.indices.insert(mesh.indices.end(), {corner, corner + 1, corner + 2});
    } else {
      mesh.indices.insert(mesh.indices.end(), {corner + 1, corner, corner + 2});
    }
  }
}

/// The point of a surface at u and v, each from 0 to 1.
using Surface = Vec3 (*)(float u, float v);

Vec3 bumpy_ball(float u, float v) {
  const float around = 2.0f * kPi * u;
  const float down = kPi * v;
  const float radius = 0.4f + 0.03f * std::sin(9.0f * around) * std::sin(11.0f * down);
  return {radius * std::sin(down) * std::cos(around), radius * std::cos(down),
          radius * std::sin(down) * std::sin(around)};
}

Vec3 ring(float u, float v) {
  const float around = 2.0f * kPi * u;
  const float across = 2.0f * kPi * v;
  const float thickness = 0.1f + 0.015f * std::sin(7.0f * around + 3.0f * across);
  const float radius = 0.35f + thickness * std::cos(across);
  return {radius * std::cos(around), thickness * std::sin(across), radius * std::sin(around)};
}

Vec3 vase(float u, float v) {
  const float around = 2.0f * kPi * u;
  const float radius =
      (0.18f + 0.1f * std::sin(5.5f * v)) * (1.0f + 0.05f * std::cos(16.0f * around));
  return {radius * std::cos(around), 0.9f * (v - 0.5f), radius * std::sin(around)};
}

/// A torus knot (2, 3), thickened along the axes of the room rather than along its own frame.
Vec3 knot(float u, float v) {
  const float around = 4.0f * kPi * u;
  const float across = 2.0f * kPi * v;
  const float turn = 1.5f * around;
  const float radius = 0.28f + 0.11f * std::cos(turn);
  const Vec3 center{radius * std::cos(around), 0.13f * std::sin(turn), radius * std::sin(around)};
  const float reach = 0.05f * std::cos(across);
  return center +
         Vec3{reach * std::cos(around), 0.05f * std::sin(across), reach * std::sin(around)};
}

/// A crumpled sheet.
Vec3 sheet(float u, float v) {
  const float height = 0.05f * std::sin(20.0f * u + 3.0f * std::sin(7.0f * v)) +
                       0.03f * std::sin(31.0f * v + 5.0f * u);
  return {0.9f * (u - 0.5f), height, 0.9f * (v - 0.5f)};
}

struct NamedSurface {
  const char* name;
  Surface surface;
};
constexpr NamedSurface kSurfaces[] = {
    {"bumpy ball", bumpy_ball}, {"ring", ring}, {"vase", vase}, {"knot", knot}, {"sheet", sheet}};

Mesh make_surface(const NamedSurface& named, uint32_t cells) {
  Mesh mesh;
  mesh.name = named.name;
  const auto size = static_cast<float>(cells);
  for (uint32_t j = 0; j <= cells; ++j) {
    for (uint32_t i = 0; i <= cells; ++i) {
      push_vertex(mesh, named.surface(static_cast<float>(i) / size, static_cast<float>(j) / size));
    }
  }
  const uint32_t row = cells + 1;
  for (uint32_t j = 0; j < cells; ++j) {
    for (uint32_t i = 0; i < cells; ++i) {
      const uint32_t a = j * row + i;
      mesh.indices.insert(mesh.indices.end(), {a, a + row, a + row + 1, a, a + row + 1, a + 1});
    }
  }
  return mesh;
}

/// The walls, the floor and the ceiling, seen from inside.
Mesh make_walls() {
  Mesh mesh;
  mesh.name = "walls";
  for (uint32_t corner = 0; corner < 8; ++corner) {
    push_vertex(mesh,
                {(corner & 1) != 0 ? kRoomSize.x : 0.0f, (corner & 2) != 0 ? kRoomSize.y : 0.0f,
                 (corner & 4) != 0 ? kRoomSize.z : 0.0f});
  }
  mesh.indices = {0, 4, 1, 1, 4, 5, 2, 3, 6, 3, 7, 6, 0, 1, 2, 1, 3, 2,
                  4, 6, 5, 5, 6, 7, 0, 2, 4, 2, 6, 4, 1, 5, 3, 3, 5, 7};
  return mesh;
}

/// A random rotation from a random unit quaternion, scaled, and moved to `position`.
std::array<float, 12> random_placement(Random& random, Vec3 position, float scale) {
  float q[4];
  float square = 0.0f;
  do {
    square = 0.0f;
    for (float& component : q) {
      component = random.uniform(-1.0f, 1.0f);
      square += component * component;
    }
  } while (square < 1e-2f || square > 1.0f);
  const float inverse = 1.0f / std::sqrt(square);
  const float w = q[0] * inverse;
  const float x = q[1] * inverse;
  const float y = q[2] * inverse;
  const float z = q[3] * inverse;
  return {scale * (1 - 2 * (y * y + z * z)), scale * 2 * (x * y - w * z),
          scale * 2 * (x * z + w * y),       position.x,
          scale * 2 * (x * y + w * z),       scale * (1 - 2 * (x * x + z * z)),
          scale * 2 * (y * z - w * x),       position.y,
          scale * 2 * (x * z - w * y),       scale * 2 * (y * z + w * x),
          scale * (1 - 2 * (x * x + y * y)), position.z};
}

}  // namespace

SceneFile make_hairball(uint64_t triangle_count) {
  Random random(1);
  Mesh mesh;
  mesh.name = "hairball";
  mesh.indices.reserve(triangle_count * 3);
  for (uint64_t done = 0; done < triangle_count; done += kTrianglesPerStrand) {
    grow_strand(mesh, random, std::min(kTrianglesPerStrand, triangle_count - done));
  }
  SceneFile scene;
  scene.meshes.push_back(std::move(mesh));
  scene.view = View{{1.3f, 0.9f, 1.8f}, {0.0f, 0.0f, 0.0f}, {0.0f, 1.0f, 0.0f}, 40.0f};
  return scene;
}

SceneFile make_room(uint64_t triangle_count) {
  SceneFile scene;
  uint32_t cells = 1;
  while (uint64_t{kCopies} * 2 * cells * cells < triangle_count) ++cells;
  for (const NamedSurface& surface : kSurfaces) {
    scene.meshes.push_back(make_surface(surface, cells));
  }
  scene.meshes.push_back(make_walls());
  const auto walls = static_cast<uint32_t>(std::size(kSurfaces));
  scene.instances.push_back({walls, {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}});
  Random random(2);
  for (uint32_t copy = 0; copy < kCopies; ++copy) {
    const float x = random.uniform(0.7f, kRoomSize.x - 0.7f);
    const float y = random.uniform(0.7f, kRoomSize.y - 0.7f);
    const float z = random.uniform(0.7f, kRoomSize.z - 0.7f);
    const float scale = random.uniform(0.5f, 1.1f);
    scene.instances.push_back({copy % walls, random_placement(random, {x, y, z}, scale)});
  }
  scene.view = View{{0.4f, 2.2f, 0.4f}, {7.0f, 1.7f, 5.5f}, {0.0f, 1.0f, 0.0f}, 60.0f};
  return scene;
}

}  // namespace kiwami::tools
