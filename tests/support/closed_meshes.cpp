// SPDX-License-Identifier: Apache-2.0
#include "support/closed_meshes.h"

#include <functional>
#include <map>
#include <numbers>
#include <utility>

#include "support/random.h"

namespace kiwami_tests {
namespace {

Point normalized(Point p) {
  const float length = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  return {p.x / length, p.y / length, p.z / length};
}

Mesh icosahedron() {
  const float g = std::numbers::phi_v<float>;
  Mesh mesh;
  mesh.vertices = {{-1, g, 0},  {1, g, 0},  {-1, -g, 0}, {1, -g, 0}, {0, -1, g},  {0, 1, g},
                   {0, -1, -g}, {0, 1, -g}, {g, 0, -1},  {g, 0, 1},  {-g, 0, -1}, {-g, 0, 1}};
  mesh.triangles = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                    {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                    {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                    {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (Point& p : mesh.vertices) p = normalized(p);
  return mesh;
}

/// Each triangle becomes four, with the new vertices on the unit sphere.
Mesh subdivided(const Mesh& coarse) {
  Mesh fine;
  fine.vertices = coarse.vertices;
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> middles;
  const auto middle = [&](uint32_t a, uint32_t b) {
    const auto key = std::minmax(a, b);
    const auto [place, is_new] =
        middles.try_emplace(key, static_cast<uint32_t>(fine.vertices.size()));
    if (is_new) fine.vertices.push_back(normalized(fine.vertices[a] + fine.vertices[b]));
    return place->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const uint32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(),
                          {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  return fine;
}

Mesh icosphere(int subdivisions) {
  Mesh mesh = icosahedron();
  for (int i = 0; i < subdivisions; ++i) mesh = subdivided(mesh);
  return mesh;
}

Mesh transformed(Mesh mesh, const std::function<Point(Point)>& transform) {
  for (Point& p : mesh.vertices) p = transform(p);
  return mesh;
}

/// A grid of rings x sides quads, closed in both directions.
Mesh torus(uint32_t rings, uint32_t sides, float radius, float tube) {
  Mesh mesh;
  const float turn = 2.0f * std::numbers::pi_v<float>;
  for (uint32_t i = 0; i < rings; ++i) {
    for (uint32_t j = 0; j < sides; ++j) {
      const float a = turn * static_cast<float>(i) / static_cast<float>(rings);
      const float b = turn * static_cast<float>(j) / static_cast<float>(sides);
      const float distance = radius + tube * std::cos(b);
      mesh.vertices.push_back({distance * std::cos(a), distance * std::sin(a), tube * std::sin(b)});
    }
  }
  const auto at = [&](uint32_t i, uint32_t j) { return (i % rings) * sides + j % sides; };
  for (uint32_t i = 0; i < rings; ++i) {
    for (uint32_t j = 0; j < sides; ++j) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  }
  return mesh;
}

/// An axis-aligned box whose faces are cut at the given coordinates of each axis.
Mesh cut_box(const std::array<std::vector<float>, 3>& cuts) {
  Mesh mesh;
  std::map<std::array<size_t, 3>, uint32_t> numbers;
  const auto vertex = [&](std::array<size_t, 3> place) {
    const auto [found, is_new] =
        numbers.try_emplace(place, static_cast<uint32_t>(mesh.vertices.size()));
    if (is_new) {
      mesh.vertices.push_back({cuts[0][place[0]], cuts[1][place[1]], cuts[2][place[2]]});
    }
    return found->second;
  };
  for (size_t axis = 0; axis < 3; ++axis) {
    const size_t first = (axis + 1) % 3, second = (axis + 2) % 3;
    for (const bool is_upper : {false, true}) {
      for (size_t i = 0; i + 1 < cuts[first].size(); ++i) {
        for (size_t j = 0; j + 1 < cuts[second].size(); ++j) {
          const auto corner = [&](size_t di, size_t dj) {
            std::array<size_t, 3> place{};
            place[axis] = is_upper ? cuts[axis].size() - 1 : 0;
            place[first] = i + di;
            place[second] = j + dj;
            return vertex(place);
          };
          const uint32_t a = corner(0, 0), b = corner(1, 0), c = corner(1, 1), d = corner(0, 1);
          if (is_upper) {
            mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {a, c, d}});
          } else {
            mesh.triangles.insert(mesh.triangles.end(), {{a, c, b}, {a, d, c}});
          }
        }
      }
    }
  }
  return mesh;
}

/// Slivers of 1 : 2^20 beside ordinary triangles.
Mesh sliver_box() {
  std::vector<float> many;
  for (int i = 0; i <= 24; ++i) many.push_back(static_cast<float>(i) / 24.0f);
  return cut_box({std::vector<float>{0.0f, 0x1p-20f, 0.3f, 1.0f - 0x1p-20f, 1.0f}, many,
                  std::vector<float>{0.0f, 0x1p-22f, 1.0f}});
}

Mesh integer_box() {
  const std::vector<float> grid{-4, -3, -2, -1, 0, 1, 2, 3, 4};
  return cut_box({grid, grid, grid});
}

/// A small core with one spike in eight vertices, each 30 times as long as the core is wide.
Mesh star() {
  Random random(7);
  return transformed(icosphere(3), [&](Point p) {
    const float radius = random.one_in(8) ? 1.0f + random.unit() : 0.05f + 0.02f * random.unit();
    return p * radius;
  });
}

}  // namespace

std::vector<ClosedMesh> closed_meshes() {
  const Point origin{0, 0, 0};
  std::vector<ClosedMesh> meshes;
  meshes.push_back({"sphere", icosphere(3), {origin, {0.5f, -0.25f, 0.125f}, {0, 0, 0.875f}}, {}});
  meshes.push_back({"torus",
                    torus(32, 16, 2.0f, 0.5f),
                    {{2, 0, 0}, {0, -2, 0.125f}, {-1.25f, 1.5f, 0}},
                    {origin, {0, 0.5f, 0.25f}, {1.25f, 0, 0.75f}}});
  meshes.push_back({"sliver box",
                    sliver_box(),
                    {{0.5f, 0.5f, 0.5f}, {0.125f, 0.875f, 0.25f}, {0.9f, 0.1f, 0.7f}},
                    {}});
  meshes.push_back({"star", star(), {origin, {0.01f, -0.02f, 0.0f}}, {}});
  const Point far{12345.678f, -301234.5f, 7890.12f};
  meshes.push_back({"far sphere",
                    transformed(icosphere(3), [&](Point p) { return p * 10.0f + far; }),
                    {far, far + Point{3, -4, 2}},
                    {}});
  meshes.push_back({"10^7 : 1 sphere",
                    transformed(icosphere(3),
                                [](Point p) {
                                  return Point{p.x * 1e7f, p.y, p.z};
                                }),
                    {origin, {5e6f, 0.25f, -0.25f}, {-8e6f, 0, 0.125f}},
                    {}});
  meshes.push_back({"integer box", integer_box(), {origin, {1, -2, 3}, {0.5f, 0.5f, -3}}, {}});
  return meshes;
}

Scene scene_of(const ClosedMesh& closed) { return {closed.name, {closed.mesh}}; }

bool is_closed(const Mesh& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> uses;
  for (const auto& index : mesh.triangles) {
    for (size_t k = 0; k < 3; ++k) ++uses[{index[k], index[(k + 1) % 3]}];
  }
  for (const auto& [edge, count] : uses) {
    const auto opposite = uses.find({edge.second, edge.first});
    if (count != 1 || opposite == uses.end()) return false;
  }
  return true;
}

}  // namespace kiwami_tests
