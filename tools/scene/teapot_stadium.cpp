// SPDX-License-Identifier: Apache-2.0
#include "scene/teapot_stadium.h"

#include <numbers>

namespace kiwami::tools {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;

/// A point of a cubic Bezier curve's control polygon.
using Curve = Vec3[4];

Vec3 curve_point(const Curve& c, float t) {
  const float s = 1.0f - t;
  return c[0] * (s * s * s) + c[1] * (3.0f * s * s * t) + c[2] * (3.0f * s * t * t) +
         c[3] * (t * t * t);
}

Vec3 curve_tangent(const Curve& c, float t) {
  const float s = 1.0f - t;
  return normalize((c[1] - c[0]) * (s * s) + (c[2] - c[1]) * (2.0f * s * t) +
                   (c[3] - c[2]) * (t * t));
}

void push_vertex(Mesh& mesh, Vec3 v) { mesh.vertices.insert(mesh.vertices.end(), {v.x, v.y, v.z}); }

/// Joins `rings` closed rings of `segments` vertices each, which begin at vertex `first`.
void join_rings(Mesh& mesh, uint32_t first, uint32_t rings, uint32_t segments) {
  for (uint32_t j = 0; j + 1 < rings; ++j) {
    for (uint32_t i = 0; i < segments; ++i) {
      const uint32_t next = (i + 1) % segments;
      const uint32_t a = first + j * segments + i;
      const uint32_t b = first + j * segments + next;
      mesh.indices.insert(mesh.indices.end(), {a, a + segments, b});
      mesh.indices.insert(mesh.indices.end(), {b, a + segments, b + segments});
    }
  }
}

/// Closes the ring that begins at `ring` by a fan around `center`.
void close_ring(Mesh& mesh, uint32_t ring, uint32_t segments, Vec3 center, bool upwards) {
  const auto apex = static_cast<uint32_t>(mesh.vertex_count());
  push_vertex(mesh, center);
  for (uint32_t i = 0; i < segments; ++i) {
    const uint32_t a = ring + i;
    const uint32_t b = ring + (i + 1) % segments;
    if (upwards) {
      mesh.indices.insert(mesh.indices.end(), {a, apex, b});
    } else {
      mesh.indices.insert(mesh.indices.end(), {a, b, apex});
    }
  }
}

/// Turns a profile (x is the radius, y the height) around the y axis. Its ends on the axis are
/// closed by fans.
template <size_t Count>
Mesh make_revolution(const Curve (&profile)[Count], uint32_t steps, uint32_t segments) {
  std::vector<Vec3> points;
  for (const Curve& curve : profile) {
    for (uint32_t i = 0; i < steps; ++i) {
      points.push_back(curve_point(curve, static_cast<float>(i) / static_cast<float>(steps)));
    }
  }
  points.push_back(profile[Count - 1][3]);
  Mesh mesh;
  for (size_t ring = 1; ring + 1 < points.size(); ++ring) {
    for (uint32_t i = 0; i < segments; ++i) {
      const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(segments);
      push_vertex(mesh, {points[ring].x * std::cos(angle), points[ring].y,
                         points[ring].x * std::sin(angle)});
    }
  }
  const auto rings = static_cast<uint32_t>(points.size() - 2);
  join_rings(mesh, 0, rings, segments);
  close_ring(mesh, 0, segments, points.front(), false);
  close_ring(mesh, (rings - 1) * segments, segments, points.back(), true);
  return mesh;
}

/// A closed tube along a curve in the plane z = 0; its radii go from `first` to `last`.
Mesh make_tube(const Curve& path, float first, float last, uint32_t steps, uint32_t segments) {
  Mesh mesh;
  for (uint32_t j = 0; j <= steps; ++j) {
    const float t = static_cast<float>(j) / static_cast<float>(steps);
    const Vec3 center = curve_point(path, t);
    const Vec3 tangent = curve_tangent(path, t);
    const Vec3 side = {-tangent.y, tangent.x, 0.0f};
    const float radius = first + (last - first) * t;
    for (uint32_t i = 0; i < segments; ++i) {
      const float angle = 2.0f * kPi * static_cast<float>(i) / static_cast<float>(segments);
      push_vertex(mesh, center + side * (radius * std::cos(angle)) +
                            Vec3{0.0f, 0.0f, radius * std::sin(angle)});
    }
  }
  join_rings(mesh, 0, steps + 1, segments);
  close_ring(mesh, 0, segments, path[0], false);
  close_ring(mesh, steps * segments, segments, path[3], true);
  return mesh;
}

void append(Mesh& mesh, const Mesh& part) {
  const auto first = static_cast<uint32_t>(mesh.vertex_count());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const uint32_t index : part.indices) mesh.indices.push_back(first + index);
}

Mesh make_body() {
  const Curve profile[] = {
      {{0.0f, 0.0f, 0}, {0.5f, 0.0f, 0}, {1.0f, 0.0f, 0}, {1.1f, 0.05f, 0}},
      {{1.1f, 0.05f, 0}, {1.15f, 0.15f, 0}, {1.65f, 0.45f, 0}, {1.65f, 1.0f, 0}},
      {{1.65f, 1.0f, 0}, {1.65f, 1.55f, 0}, {1.3f, 1.9f, 0}, {1.15f, 2.1f, 0}},
      {{1.15f, 2.1f, 0}, {1.1f, 2.2f, 0}, {1.0f, 2.2f, 0}, {1.0f, 2.1f, 0}},
      {{1.0f, 2.1f, 0}, {0.7f, 2.05f, 0}, {0.3f, 2.05f, 0}, {0.0f, 2.05f, 0}},
  };
  return make_revolution(profile, 36, 180);
}

Mesh make_lid() {
  const Curve profile[] = {
      {{0.0f, 2.08f, 0}, {0.4f, 2.08f, 0}, {0.8f, 2.08f, 0}, {0.98f, 2.12f, 0}},
      {{0.98f, 2.12f, 0}, {0.9f, 2.3f, 0}, {0.35f, 2.35f, 0}, {0.15f, 2.48f, 0}},
      {{0.15f, 2.48f, 0}, {0.08f, 2.55f, 0}, {0.28f, 2.6f, 0}, {0.28f, 2.72f, 0}},
      {{0.28f, 2.72f, 0}, {0.28f, 2.82f, 0}, {0.15f, 2.88f, 0}, {0.0f, 2.88f, 0}},
  };
  return make_revolution(profile, 24, 120);
}

Mesh make_teapot() {
  const Curve spout = {{1.4f, 0.7f, 0}, {2.3f, 0.7f, 0}, {1.9f, 1.9f, 0}, {2.6f, 2.1f, 0}};
  const Curve handle = {{-1.3f, 1.75f, 0}, {-2.9f, 2.2f, 0}, {-2.5f, 0.7f, 0}, {-1.5f, 0.6f, 0}};
  Mesh mesh;
  mesh.name = "teapot";
  append(mesh, make_body());
  append(mesh, make_lid());
  append(mesh, make_tube(spout, 0.45f, 0.14f, 80, 90));
  append(mesh, make_tube(handle, 0.15f, 0.15f, 100, 60));
  return mesh;
}

/// Tiers of steps around an oval, open towards the floor.
Mesh make_tiers() {
  constexpr uint32_t kSegments = 48;
  constexpr uint32_t kTiers = 12;
  Mesh mesh;
  mesh.name = "stadium tiers";
  uint32_t rings = 0;
  const auto push_ring = [&](float radius, float height) {
    for (uint32_t i = 0; i < kSegments; ++i) {
      // Against the direction of the other rings: a bowl is seen from its inside.
      const float angle = -2.0f * kPi * static_cast<float>(i) / static_cast<float>(kSegments);
      push_vertex(mesh, {(radius + 40.0f) * std::cos(angle), height, radius * std::sin(angle)});
    }
    ++rings;
  };
  for (uint32_t tier = 0; tier < kTiers; ++tier) {
    const auto step = static_cast<float>(tier);
    push_ring(60.0f + 4.0f * step, 3.0f * step);
    push_ring(60.0f + 4.0f * step, 3.0f * step + 3.0f);
  }
  push_ring(110.0f, 3.0f * kTiers);
  push_ring(110.0f, 0.0f);
  join_rings(mesh, 0, rings, kSegments);
  return mesh;
}

Mesh make_floor() {
  Mesh mesh;
  mesh.name = "stadium floor";
  mesh.vertices = {-170, 0, -130, 170, 0, -130, 170, 0, 130, -170, 0, 130};
  mesh.indices = {0, 2, 1, 0, 3, 2};
  return mesh;
}

}  // namespace

SceneFile make_teapot_stadium() {
  SceneFile scene;
  scene.meshes.push_back(make_teapot());
  scene.meshes.push_back(make_tiers());
  scene.meshes.push_back(make_floor());
  scene.view = View{{3.4f, 2.9f, 8.4f}, {0.15f, 1.75f, 0.0f}, {0.0f, 1.0f, 0.0f}, 40.0f};
  return scene;
}

}  // namespace kiwami::tools
