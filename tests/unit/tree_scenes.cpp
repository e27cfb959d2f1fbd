// SPDX-License-Identifier: Apache-2.0
#include "unit/tree_scenes.h"

#include <atomic>
#include <cmath>
#include <thread>
#include <utility>

#include "support/random.h"

namespace kiwami_tests {
namespace {

constexpr float kPi = 3.14159265f;

Point random_point(Random& random, float size) {
  const float x = random.symmetric(), y = random.symmetric(), z = random.symmetric();
  return Point{x, y, z} * size;
}

void add_small_triangle(Mesh& mesh, Random& random, Point at, float extent) {
  const Point a = at + random_point(random, extent);
  const Point b = at + random_point(random, extent);
  const Point c = at + random_point(random, extent);
  mesh.add(a, b, c);
}

/// count triangles whose centres are place(i).
template <typename Place>
Mesh placed(uint32_t count, Random& random, float extent, Place place) {
  Mesh mesh;
  for (uint32_t i = 0; i < count; ++i) add_small_triangle(mesh, random, place(i), extent);
  return mesh;
}

Mesh scaled(Mesh mesh, float factor) {
  for (Point& vertex : mesh.vertices) vertex = vertex * factor;
  return mesh;
}

void add_sphere(Mesh& mesh, Point centre, float radius, uint32_t rings, uint32_t& left) {
  const auto at = [&](uint32_t ring, uint32_t sector) {
    const float theta = kPi * static_cast<float>(ring) / static_cast<float>(rings);
    const float phi = 2 * kPi * static_cast<float>(sector) / static_cast<float>(rings);
    return centre + Point{std::sin(theta) * std::cos(phi), std::cos(theta),
                          std::sin(theta) * std::sin(phi)} *
                        radius;
  };
  for (uint32_t i = 0; i < rings; ++i) {
    for (uint32_t j = 0; j < rings && left >= 2; ++j, left -= 2) {
      mesh.add(at(i, j), at(i + 1, j), at(i, j + 1));
      mesh.add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
}

}  // namespace

TreeScene::TreeScene(std::string name, Mesh mesh) : name_(std::move(name)), mesh_(std::move(mesh)) {
  view_ = {reinterpret_cast<const unsigned char*>(mesh_.vertices.data()),
           sizeof(Point),
           mesh_.vertices.size(),
           reinterpret_cast<const unsigned char*>(mesh_.triangles.data()),
           sizeof(mesh_.triangles[0]),
           static_cast<uint32_t>(mesh_.triangles.size()),
           0,
           0,
           ~0u};
  source_ = {&view_, 1};
}

kiwami::Array<kiwami::BuildPrimitive> TreeScene::primitives(kiwami::Memory& memory) const {
  return primitives_of(mesh_, memory);
}

kiwami::Array<kiwami::BuildPrimitive> primitives_of(const Mesh& mesh, kiwami::Memory& memory) {
  kiwami::Array<kiwami::BuildPrimitive> primitives(memory, mesh.triangles.size());
  for (size_t i = 0; i < primitives.size(); ++i) {
    kiwami::Bounds box = kiwami::Bounds::empty();
    for (const Point& corner : mesh.corners(i)) {
      box.extend(kiwami::Vec3f{corner.x, corner.y, corner.z});
    }
    primitives[i] = {box.lower, static_cast<uint32_t>(i), box.upper, 0};
  }
  return primitives;
}

Mesh terrain(uint32_t rows) {
  const auto at = [&](uint32_t i, uint32_t j) {
    const float x = static_cast<float>(i) * 100.0f / static_cast<float>(rows);
    const float z = static_cast<float>(j) * 100.0f / static_cast<float>(rows);
    return Point{x, 5 * std::sin(x * 0.3f) * std::cos(z * 0.2f) + std::sin(x * 3.1f + z * 2.0f), z};
  };
  Mesh mesh;
  for (uint32_t i = 0; i < rows; ++i) {
    for (uint32_t j = 0; j < rows; ++j) {
      mesh.add(at(i, j), at(i + 1, j), at(i, j + 1));
      mesh.add(at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
    }
  }
  return mesh;
}

Mesh soup(uint32_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (uint32_t i = 0; i < count; ++i) {
    const Point at = random_point(random, 100.0f);
    add_small_triangle(mesh, random, at, random.power_of_two(-4, 4));
  }
  return mesh;
}

Mesh spheres(uint32_t count, uint64_t seed) {
  Random random(seed);
  Mesh mesh;
  for (uint32_t left = count; left >= 2;) {
    const Point centre = random_point(random, 100.0f);
    const float radius = random.power_of_two(-2, 3);
    add_sphere(mesh, centre, radius, 4 + random.below(60), left);
  }
  return mesh;
}

std::vector<NamedMesh> degenerate_meshes(uint64_t seed) {
  Random random(seed);
  const Point origin{0, 0, 0};
  std::vector<NamedMesh> meshes;
  for (const uint32_t count : {1u, 2u, 3u, 7u, 8u, 9u, 15u, 16u, 17u, 64u, 65u}) {
    meshes.push_back({"soup of " + std::to_string(count), soup(count, seed + count)});
  }
  Mesh equal;
  for (int i = 0; i < 1000; ++i) equal.add({0, 0, 0}, {1, 0, 0}, {0, 1, 2});
  meshes.push_back({"all equal", equal});
  Mesh points;
  for (int i = 0; i < 300; ++i) {
    const Point at = random_point(random, 1.0f);
    points.add(at, at, at);
  }
  meshes.push_back({"points", points});
  Mesh line;
  for (int i = 0; i < 300; ++i) {
    const float x = static_cast<float>(random.below(100));
    line.add({x, 1, 1}, {x + 1, 1, 1}, {x + 0.5f, 1, 1});
  }
  meshes.push_back({"without area, along an axis", line});
  Mesh plane = soup(500, seed);
  for (Point& vertex : plane.vertices) vertex.z = 3;
  meshes.push_back({"coplanar", plane});
  meshes.push_back({"centroids in a line", placed(500, random, 0.1f, [](uint32_t i) {
                      return Point{1, 2, 3} * static_cast<float>(i);
                    })});
  meshes.push_back({"grid of equal centroids", placed(4096, random, 0.0f, [](uint32_t i) {
                      return Point{static_cast<float>(i % 8), static_cast<float>(i / 8 % 8),
                                   static_cast<float>(i / 64 % 8)};
                    })});
  meshes.push_back({"two far clusters", placed(500, random, 0.001f, [](uint32_t i) {
                      return i % 5 == 0 ? Point{1e6f, 0, 0} : Point{-1e6f, 1, 0};
                    })});
  // Each bin but the last holds one triangle at most: a tree as deep as the format allows.
  meshes.push_back({"geometric progression", placed(250, random, 0.0f, [](uint32_t i) {
                      return Point{std::ldexp(1.0f, static_cast<int>(i % 120) - 60), 0, 0};
                    })});
  Mesh nested;
  for (int i = 1; i <= 500; ++i) {
    const float size = static_cast<float>(i);
    nested.add({-size, -size, -size}, {size, size, size}, {size, -size, 0});
  }
  meshes.push_back({"nested", nested});
  Mesh giant = soup(500, seed + 1);
  giant.add({-1e6f, -1e6f, -1e6f}, {1e6f, 1e6f, 1e6f}, {1e6f, -1e6f, 0});
  meshes.push_back({"one huge among tiny ones", giant});
  meshes.push_back({"at 2^60", scaled(soup(300, seed + 2), 0x1p53f)});
  meshes.push_back({"denormal", scaled(soup(300, seed + 3), 1e-43f)});
  meshes.push_back({"areas underflow", scaled(soup(300, seed + 4), 1e-30f)});
  meshes.push_back({"at the origin", placed(100, random, 0.0f, [&](uint32_t) { return origin; })});
  return meshes;
}

int32_t run_on_plain_threads(void*, size_t count, kiwami_parallel_task task, void* task_data) {
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i = next++; i < count; i = next++) task(task_data, i);
  };
  std::thread others[3] = {std::thread(work), std::thread(work), std::thread(work)};
  work();
  for (std::thread& other : others) other.join();
  return 0;
}

}  // namespace kiwami_tests
