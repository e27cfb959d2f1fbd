// SPDX-License-Identifier: Apache-2.0
#include "scene/procedural.h"

#include <charconv>
#include <string_view>
#include <unordered_map>

#include "scene/forest.h"
#include "scene/large_scenes.h"
#include "scene/random.h"
#include "scene/teapot_stadium.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kMaxSphereLevel = 9;
constexpr uint32_t kMaxTerrainCells = 4096;
constexpr uint32_t kMaxSoupTriangles = 10000000;
constexpr uint32_t kMaxLargeTriangles = 100000000;
constexpr uint32_t kMaxForestTrees = 1000000;
// What the names of the large scenes mean without a number.
constexpr uint32_t kTerrainCells = 1415;
constexpr uint32_t kHairballTriangles = 2000000;
constexpr uint32_t kRoomTriangles = 10000000;
constexpr uint32_t kForestTrees = 600;

void push_vertex(Mesh& mesh, Vec3 v) { mesh.vertices.insert(mesh.vertices.end(), {v.x, v.y, v.z}); }

Vec3 vertex(const Mesh& mesh, uint32_t index) {
  const float* v = &mesh.vertices[size_t{index} * 3];
  return {v[0], v[1], v[2]};
}

Mesh make_icosahedron() {
  const float a = 1.0f;
  const float b = 1.618034f;  // the golden ratio
  const Vec3 corners[12] = {{-a, b, 0}, {a, b, 0}, {-a, -b, 0}, {a, -b, 0},
                            {0, -a, b}, {0, a, b}, {0, -a, -b}, {0, a, -b},
                            {b, 0, -a}, {b, 0, a}, {-b, 0, -a}, {-b, 0, a}};
  Mesh mesh;
  for (const Vec3& corner : corners) push_vertex(mesh, normalize(corner));
  mesh.indices = {0, 11, 5,  0, 5,  1, 0, 1, 7, 0, 7,  10, 0, 10, 11, 1, 5, 9, 5, 11,
                  4, 11, 10, 2, 10, 7, 6, 7, 1, 8, 3,  9,  4, 3,  4,  2, 3, 2, 6, 3,
                  6, 8,  3,  8, 9,  4, 9, 5, 2, 4, 11, 6,  2, 10, 8,  6, 7, 9, 8, 1};
  return mesh;
}

/// Each triangle becomes four; the middle of an edge is made once, so the mesh stays closed.
Mesh divide_sphere(const Mesh& coarse) {
  Mesh fine;
  fine.vertices = coarse.vertices;
  fine.indices.reserve(coarse.indices.size() * 4);
  std::unordered_map<uint64_t, uint32_t> middles;
  middles.reserve(coarse.indices.size());
  const auto middle = [&](uint32_t i, uint32_t j) {
    const uint64_t key = i < j ? uint64_t{i} << 32 | j : uint64_t{j} << 32 | i;
    const auto [entry, added] =
        middles.try_emplace(key, static_cast<uint32_t>(fine.vertex_count()));
    if (added) push_vertex(fine, normalize(vertex(coarse, i) + vertex(coarse, j)));
    return entry->second;
  };
  for (size_t i = 0; i < coarse.indices.size(); i += 3) {
    const uint32_t a = coarse.indices[i];
    const uint32_t b = coarse.indices[i + 1];
    const uint32_t c = coarse.indices[i + 2];
    const uint32_t ab = middle(a, b);
    const uint32_t bc = middle(b, c);
    const uint32_t ca = middle(c, a);
    fine.indices.insert(fine.indices.end(), {a, ab, ca, b, bc, ab, c, ca, bc, ab, bc, ca});
  }
  return fine;
}

/// A random height in [0, 1) of a lattice point.
float lattice_height(uint32_t x, uint32_t y, uint32_t octave) {
  return Random(uint64_t{x} << 32 | y, octave).uniform();
}

/// Value noise: lattice heights, interpolated smoothly.
float value_noise(float x, float y, uint32_t octave) {
  const auto ix = static_cast<uint32_t>(x);
  const auto iy = static_cast<uint32_t>(y);
  const float fx = x - static_cast<float>(ix);
  const float fy = y - static_cast<float>(iy);
  const float sx = fx * fx * (3.0f - 2.0f * fx);
  const float sy = fy * fy * (3.0f - 2.0f * fy);
  const float low =
      lattice_height(ix, iy, octave) * (1.0f - sx) + lattice_height(ix + 1, iy, octave) * sx;
  const float high = lattice_height(ix, iy + 1, octave) * (1.0f - sx) +
                     lattice_height(ix + 1, iy + 1, octave) * sx;
  return low * (1.0f - sy) + high * sy;
}

float terrain_height(float x, float y, uint32_t octaves) {
  float height = 0.0f;
  float frequency = 4.0f;
  float amplitude = 0.5f;
  for (uint32_t octave = 0; octave < octaves; ++octave) {
    height += amplitude * value_noise(x * frequency, y * frequency, octave);
    frequency *= 2.0f;
    amplitude *= 0.5f;
  }
  return height;
}

/// Six, or as many as it takes to reach the size of two cells: a fine terrain is rough, too.
uint32_t terrain_octaves(uint32_t cells) {
  uint32_t octaves = 6;
  while ((4u << octaves) <= cells / 2) ++octaves;
  return octaves;
}

Vec3 random_in_cube(Random& random) {
  const float x = random.uniform(-1.0f, 1.0f);
  const float y = random.uniform(-1.0f, 1.0f);
  const float z = random.uniform(-1.0f, 1.0f);
  return {x, y, z};
}

/// A whole number at the front of `text`, which is moved past it and past a colon that follows.
uint64_t take_number(std::string_view& text, const std::string& name, const char* meaning,
                     uint64_t lowest, uint64_t highest) {
  uint64_t number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool at_end = end == text.data() + text.size() || *end == ':';
  if (error != std::errc() || !at_end || number < lowest || number > highest) {
    throw SceneError("the scene '" + name + "' wants " + meaning + " of " + std::to_string(lowest) +
                     " to " + std::to_string(highest));
  }
  text.remove_prefix(static_cast<size_t>(end - text.data()));
  if (!text.empty()) text.remove_prefix(1);
  return number;
}

SceneFile scene_of(Mesh mesh, const std::string& name) {
  mesh.name = name;
  SceneFile scene;
  scene.meshes.push_back(std::move(mesh));
  return scene;
}

SceneFile large_terrain() {
  SceneFile scene = scene_of(make_terrain(kTerrainCells), "terrain");
  scene.view = View{{-0.85f, 0.55f, -0.95f}, {0.1f, 0.0f, 0.1f}, {0.0f, 1.0f, 0.0f}, 45.0f};
  return scene;
}

}  // namespace

Mesh make_sphere(uint32_t level) {
  Mesh mesh = make_icosahedron();
  for (uint32_t i = 0; i < level; ++i) mesh = divide_sphere(mesh);
  return mesh;
}

Mesh make_terrain(uint32_t cells) {
  Mesh mesh;
  const auto size = static_cast<float>(cells);
  const uint32_t octaves = terrain_octaves(cells);
  for (uint32_t j = 0; j <= cells; ++j) {
    for (uint32_t i = 0; i <= cells; ++i) {
      const float x = static_cast<float>(i) / size;
      const float z = static_cast<float>(j) / size;
      push_vertex(mesh, {2.0f * x - 1.0f, terrain_height(x, z, octaves) - 0.5f, 2.0f * z - 1.0f});
    }
  }
  const uint32_t row = cells + 1;
  mesh.indices.reserve(size_t{cells} * cells * 6);
  for (uint32_t j = 0; j < cells; ++j) {
    for (uint32_t i = 0; i < cells; ++i) {
      const uint32_t a = j * row + i;
      mesh.indices.insert(mesh.indices.end(), {a, a + row, a + row + 1, a, a + row + 1, a + 1});
    }
  }
  return mesh;
}

Mesh make_soup(uint32_t triangle_count, uint64_t seed) {
  constexpr float kSizes[4] = {0.001f, 0.01f, 0.1f, 1.0f};
  Random random(seed);
  Mesh mesh;
  for (uint32_t i = 0; i < triangle_count; ++i) {
    const Vec3 center = random_in_cube(random);
    const float size = kSizes[random.below(4)] * random.uniform(0.1f, 1.0f);
    for (uint32_t corner = 0; corner < 3; ++corner) {
      push_vertex(mesh, center + random_in_cube(random) * size);
      mesh.indices.push_back(i * 3 + corner);
    }
  }
  return mesh;
}

std::string procedural_scene_names() {
  return "stadium, terrain, hairball, room, forest, sphere:LEVEL, terrain:N, soup:N:SEED, "
         "hairball:N, "
         "room:N, forest:N";
}

std::optional<SceneFile> make_procedural_scene(const std::string& name) {
  if (name == "stadium") return make_teapot_stadium();
  if (name == "terrain") return large_terrain();
  if (name == "hairball") return make_hairball(kHairballTriangles);
  if (name == "room") return make_room(kRoomTriangles);
  if (name == "forest") return make_forest(kForestTrees);
  const size_t colon = name.find(':');
  if (colon == std::string::npos) return std::nullopt;
  const std::string kind = name.substr(0, colon);
  std::string_view rest = std::string_view(name).substr(colon + 1);
  std::optional<SceneFile> scene;
  if (kind == "sphere") {
    const uint64_t level = take_number(rest, name, "a LEVEL", 0, kMaxSphereLevel);
    scene = scene_of(make_sphere(static_cast<uint32_t>(level)), name);
  } else if (kind == "terrain") {
    const uint64_t cells = take_number(rest, name, "an N", 1, kMaxTerrainCells);
    scene = scene_of(make_terrain(static_cast<uint32_t>(cells)), name);
  } else if (kind == "soup") {
    const uint64_t count = take_number(rest, name, "an N", 1, kMaxSoupTriangles);
    const uint64_t seed = take_number(rest, name, "a SEED", 0, UINT64_MAX);
    scene = scene_of(make_soup(static_cast<uint32_t>(count), seed), name);
  } else if (kind == "hairball") {
    scene = make_hairball(take_number(rest, name, "an N", 1, kMaxLargeTriangles));
  } else if (kind == "room") {
    scene = make_room(take_number(rest, name, "an N", 1, kMaxLargeTriangles));
  } else if (kind == "forest") {
    scene = make_forest(take_number(rest, name, "an N", 1, kMaxForestTrees));
  }
  if (scene && !rest.empty()) {
    throw SceneError("the scene '" + name + "' has more numbers than " + kind + " takes");
  }
  return scene;
}

}  // namespace kiwami::tools
