// SPDX-License-Identifier: Apache-2.0
#include "generated.h"

#include <cmath>
#include <limits>

namespace generated {
namespace {

Vector operator+(Vector a, Vector b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
Vector operator-(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector operator*(Vector a, float s) { return {a.x * s, a.y * s, a.z * s}; }

/// The component of an axis, 0 to 2.
float& component(Vector& a, size_t axis) { return axis == 0 ? a.x : axis == 1 ? a.y : a.z; }

/// Never called twice in one argument list: compilers differ in the order of arguments.
Vector random_vector(Random& random) {
  const float x = random.symmetric(), y = random.symmetric(), z = random.symmetric();
  return {x, y, z};
}

Vector on_unit_sphere(Vector a) {
  return a * (1.0f / std::sqrt(a.x * a.x + a.y * a.y + a.z * a.z));
}

void add_triangle(Mesh& mesh, Vector a, Vector b, Vector c) {
  for (const Vector& vertex : {a, b, c}) {
    mesh.indices.push_back(static_cast<uint32_t>(mesh.vertices.size()));
    mesh.vertices.push_back(vertex);
  }
}

/// An octahedron, each face split into detail^2 triangles, blown up to a sphere. Vertices of
/// neighbouring faces are equal to the bit, since they come from integer coordinates.
Mesh sphere(const char* name, int detail, Vector centre, float radius) {
  Mesh mesh{name, {}, {}};
  for (int octant = 0; octant < 8; ++octant) {
    const float sx = octant & 1 ? -1.0f : 1.0f, sy = octant & 2 ? -1.0f : 1.0f,
                sz = octant & 4 ? -1.0f : 1.0f;
    const bool mirrored = sx * sy * sz < 0.0f;
    const auto corner = [&](int i, int j) {
      const Vector flat{sx * static_cast<float>(i), sy * static_cast<float>(j),
                        sz * static_cast<float>(detail - i - j)};
      return centre + on_unit_sphere(flat) * radius;
    };
    const auto add = [&](Vector a, Vector b, Vector c) {
      mirrored ? add_triangle(mesh, a, c, b) : add_triangle(mesh, a, b, c);
    };
    for (int i = 0; i < detail; ++i) {
      for (int j = 0; j < detail - i; ++j) {
        add(corner(i, j), corner(i + 1, j), corner(i, j + 1));
        if (i + j < detail - 1) add(corner(i + 1, j), corner(i + 1, j + 1), corner(i, j + 1));
      }
    }
  }
  return mesh;
}

/// Triangles whose sides differ by many orders of magnitude.
Mesh slivers(Random& random) {
  Mesh mesh{"slivers", {}, {}};
  float size = 1000.0f;
  for (int i = 0; i < 600; ++i) {
    if (i % 40 == 0) size *= 0.25f;
    const Vector a = random_vector(random), side = random_vector(random) * size;
    const Vector offset = random_vector(random) * (size * 1e-5f);
    add_triangle(mesh, a, a + side, a + side * 0.5f + offset);
  }
  return mesh;
}

/// Two sheets of squares in one plane, and each triangle twice: equal distances everywhere.
Mesh coplanar_duplicates() {
  Mesh mesh{"coplanar duplicates", {}, {}};
  for (int copy = 0; copy < 2; ++copy) {
    for (int i = -8; i < 8; ++i) {
      for (int j = -8; j < 8; ++j) {
        const float x = static_cast<float>(i) * 0.125f, y = static_cast<float>(j) * 0.125f;
        const Vector a{x, y, 0.25f}, b{x + 0.125f, y, 0.25f}, c{x + 0.125f, y + 0.125f, 0.25f},
            d{x, y + 0.125f, 0.25f};
        add_triangle(mesh, a, b, c);
        add_triangle(mesh, a, c, d);
      }
    }
  }
  return mesh;
}

/// A soup in which every seventh triangle has a vertex that is NaN, infinite or out of range.
Mesh broken_vertices(Random& random) {
  Mesh mesh{"broken vertices", {}, {}};
  const float broken[] = {std::numeric_limits<float>::quiet_NaN(),
                          std::numeric_limits<float>::infinity(), 2.0f * KIWAMI_MAX_COORDINATE};
  for (size_t i = 0; i < 300; ++i) {
    const Vector a = random_vector(random);
    const Vector b = a + random_vector(random) * 0.3f, c = a + random_vector(random) * 0.3f;
    add_triangle(mesh, a, b, c);
    if (i % 7 == 0) component(mesh.vertices.back(), i % 3) = broken[i / 7 % 3];
  }
  return mesh;
}

kiwami_ray ray_of(Vector origin, Vector direction) {
  const float infinity = std::numeric_limits<float>::infinity();
  return {origin.x,    origin.y, origin.z, 0.0f,        direction.x, direction.y,
          direction.z, infinity, 0.0f,     0xFFFFFFFFu, 0u,          0u};
}

kiwami_ray random_ray(Random& random) {
  const Vector origin = random_vector(random) * 2.0f, direction = random_vector(random);
  return ray_of(origin, direction);
}

kiwami_ray invalid_ray(Random& random) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  kiwami_ray ray = random_ray(random);
  switch (random.below(4)) {
    case 0:
      ray.origin_y = nan;
      break;
    case 1:
      ray.direction_x = ray.direction_y = ray.direction_z = 0.0f;
      break;
    case 2:
      ray.tmax = nan;
      break;
    default:
      ray.tmin = 2.0f;
      ray.tmax = 1.0f;
      break;
  }
  return ray;
}

kiwami_ray along_axis(Vector target, Random& random) {
  Vector origin = target, direction{0.0f, 0.0f, 0.0f};
  const uint32_t axis = random.below(3);
  const float sign = random.below(2) ? 1.0f : -1.0f;
  component(direction, axis) = sign;
  component(origin, axis) -= sign * 3.0f;
  return ray_of(origin, direction);
}

kiwami_ray ray_at_triangle(const Vector& a, const Vector& b, const Vector& c, Random& random) {
  const Vector outside = a + random_vector(random) * 4.0f;
  switch (random.below(6)) {
    case 0:
      return ray_of(outside, a - outside);
    case 1:
      return ray_of(outside, (a + (b - a) * 0.5f) - outside);
    case 2:
      return ray_of(a - (b - a), b - a);
    case 3:
      return along_axis(a, random);
    case 4:
      return along_axis((a + b + c) * (1.0f / 3.0f), random);
    default:
      return ray_of(outside, (a + b + c) * (1.0f / 3.0f) - outside);
  }
}

}  // namespace

std::vector<Mesh> adversarial_meshes(uint64_t seed) {
  Random random(seed);
  std::vector<Mesh> meshes;
  meshes.push_back(sphere("sphere", 12, {0.0f, 0.0f, 0.0f}, 1.0f));
  meshes.push_back(sphere("distant sphere", 8, {1.0e5f, -3.0e4f, 7.0f}, 1.0f));
  meshes.push_back(slivers(random));
  meshes.push_back(coplanar_duplicates());
  meshes.push_back(broken_vertices(random));
  Mesh one{"one triangle", {}, {}};
  const Vector a = random_vector(random), b = random_vector(random), c = random_vector(random);
  add_triangle(one, a, b, c);
  meshes.push_back(one);
  meshes.push_back({"no triangle", {}, {}});
  return meshes;
}

std::vector<kiwami_ray> adversarial_rays(const Mesh& mesh, size_t count, Random& random) {
  std::vector<kiwami_ray> rays;
  rays.reserve(count);
  while (rays.size() < count) {
    if (random.below(64) == 0) {
      rays.push_back(invalid_ray(random));
      continue;
    }
    if (mesh.indices.empty() || random.below(8) == 0) {
      rays.push_back(random_ray(random));
      continue;
    }
    const size_t triangle = random.below(static_cast<uint32_t>(mesh.triangle_count()));
    const uint32_t* corner = &mesh.indices[3 * triangle];
    const uint32_t turn = random.below(3);
    kiwami_ray ray =
        ray_at_triangle(mesh.vertices[corner[turn]], mesh.vertices[corner[(turn + 1) % 3]],
                        mesh.vertices[corner[(turn + 2) % 3]], random);
    if (random.below(4) == 0) ray.tmax = 1.0f;
    if (random.below(8) == 0) ray.tmin = 0.5f;
    if (random.below(4) == 0) ray.flags = 1u << random.below(2);
    rays.push_back(ray);
  }
  return rays;
}

}  // namespace generated
