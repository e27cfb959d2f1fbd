// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

namespace kiwami_tests {

struct Point {
  float x, y, z;

  float& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
  float operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  bool operator==(const Point&) const = default;
};

inline Point operator+(Point a, Point b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Point operator*(Point a, float s) { return {a.x * s, a.y * s, a.z * s}; }

/// One geometry of a test scene.
struct Mesh {
  std::vector<Point> vertices;
  std::vector<std::array<uint32_t, 3>> triangles;
  uint32_t mask = ~0u;

  /// Appends three vertices of its own and a triangle of them.
  void add(Point a, Point b, Point c) {
    const auto first = static_cast<uint32_t>(vertices.size());
    vertices.insert(vertices.end(), {a, b, c});
    triangles.push_back({first, first + 1, first + 2});
  }

  std::array<Point, 3> corners(size_t triangle) const {
    const auto& index = triangles[triangle];
    return {vertices[index[0]], vertices[index[1]], vertices[index[2]]};
  }
};

/// Mesh i becomes geometry i.
struct Scene {
  std::string name;
  std::vector<Mesh> meshes;

  size_t triangle_count() const {
    size_t count = 0;
    for (const Mesh& mesh : meshes) count += mesh.triangles.size();
    return count;
  }
};

}  // namespace kiwami_tests
