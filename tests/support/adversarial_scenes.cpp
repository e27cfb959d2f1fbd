// SPDX-License-Identifier: Apache-2.0
#include "support/adversarial_scenes.h"

#include <iterator>
#include <limits>

#include "support/random.h"

namespace kiwami_tests {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

Point random_point(Random& random, float size) {
  return {random.symmetric() * size, random.symmetric() * size, random.symmetric() * size};
}
Point integer_point(Random& random, int size) {
  return {static_cast<float>(random.between(-size, size)),
          static_cast<float>(random.between(-size, size)),
          static_cast<float>(random.between(-size, size))};
}
uint32_t some_count(Random& random) { return 1 + random.below(random.one_in(4) ? 400 : 60); }

/// Three points, made one after the other: the order of arguments is the compiler's choice.
template <typename MakePoint>
void add_triangle(Mesh& mesh, MakePoint make_point) {
  const Point a = make_point();
  const Point b = make_point();
  const Point c = make_point();
  mesh.add(a, b, c);
}

void add_soup(Mesh& mesh, Random& random, uint32_t count, float size, float extent) {
  for (uint32_t i = 0; i < count; ++i) {
    const Point at = random_point(random, size);
    add_triangle(mesh, [&] { return at + random_point(random, extent); });
  }
}

Mesh soup(Random& random) {
  Mesh mesh;
  const uint32_t count = some_count(random);
  add_soup(mesh, random, count, 1.0f, random.power_of_two(-6, 0));
  return mesh;
}

Mesh slivers(Random& random) {
  Mesh mesh;
  for (uint32_t i = some_count(random); i > 0; --i) {
    const Point a = random_point(random, 1.0f), b = random_point(random, 1.0f);
    const Point near_c = random.one_in(2) ? a : (a + b) * 0.5f;
    mesh.add(a, b, near_c + random_point(random, random.power_of_two(-26, -10)));
  }
  return mesh;
}

Mesh coplanar(Random& random) {
  Mesh mesh;
  const int axis = random.between(0, 2);
  const float level = random.symmetric();
  add_soup(mesh, random, some_count(random), 1.0f, 0.5f);
  for (Point& p : mesh.vertices) p[axis] = level;
  return mesh;
}

Mesh duplicated(Random& random) {
  Mesh mesh;
  add_soup(mesh, random, 1 + random.below(20), 1.0f, 0.5f);
  const auto originals = static_cast<uint32_t>(mesh.triangles.size());
  for (uint32_t i = some_count(random); i > 0; --i) {
    auto copy = mesh.triangles[random.below(originals)];
    if (random.one_in(3)) std::swap(copy[0], copy[1 + random.below(2)]);
    mesh.triangles.push_back(copy);
  }
  return mesh;
}

Mesh huge_and_tiny(Random& random) {
  Mesh mesh;
  for (uint32_t i = some_count(random); i > 0; --i) {
    const float size = random.power_of_two(-30, 30);
    add_soup(mesh, random, 1, size, size);
  }
  return mesh;
}

Mesh with_bad_vertices(Random& random) {
  Mesh mesh = soup(random);
  const float bad[] = {kNan,           kInfinity, -kInfinity,
                       0x1.000002p60f, -0x1p100f, std::numeric_limits<float>::max()};
  for (Point& p : mesh.vertices) {
    if (random.one_in(9)) p[random.between(0, 2)] = bad[random.below(std::size(bad))];
  }
  return mesh;
}

Mesh few(Random& random) {
  Mesh mesh;
  add_soup(mesh, random, random.below(3), 1.0f, 1.0f);
  return mesh;
}

Mesh identical(Random& random) {
  Mesh mesh;
  add_soup(mesh, random, 1, 1.0f, 1.0f);
  const auto triangle = mesh.triangles[0];
  mesh.triangles.assign(some_count(random), triangle);
  return mesh;
}

Mesh degenerate(Random& random) {
  Mesh mesh;
  for (uint32_t i = some_count(random); i > 0; --i) {
    const Point a = integer_point(random, 3), b = integer_point(random, 3);
    switch (random.below(5)) {
      case 0:
        mesh.add(a, a, a);
        break;
      case 1:
        mesh.add(a, b, a);
        break;
      case 2:
        mesh.add(a, b, (a + b) * 0.5f);
        break;
      case 3:
        mesh.add(a, b + b - a, b);
        break;
      default:
        mesh.add(a, b, integer_point(random, 3));
    }
  }
  return mesh;
}

/// A height field on integers: shared vertices and edges, many rays exactly through them.
Mesh shared_grid(Random& random) {
  Mesh mesh;
  const uint32_t size = 2 + random.below(10);
  for (uint32_t i = 0; i <= size; ++i) {
    for (uint32_t j = 0; j <= size; ++j) {
      mesh.vertices.push_back(
          {static_cast<float>(i), static_cast<float>(j), static_cast<float>(random.between(0, 2))});
    }
  }
  for (uint32_t i = 0; i < size; ++i) {
    for (uint32_t j = 0; j < size; ++j) {
      const uint32_t a = i * (size + 1) + j, b = a + size + 1;
      mesh.triangles.push_back({a, b, b + 1});
      mesh.triangles.push_back({a, b + 1, a + 1});
    }
  }
  return mesh;
}

/// Triangles round one vertex, in random order.
Mesh fan(Random& random) {
  Mesh mesh;
  const uint32_t count = 3 + random.below(40);
  mesh.vertices.push_back(random_point(random, 1.0f));
  for (uint32_t i = 0; i < count; ++i) mesh.vertices.push_back(random_point(random, 2.0f));
  for (uint32_t i = 0; i < count; ++i) mesh.triangles.push_back({0, 1 + i, 1 + (i + 1) % count});
  return mesh;
}

Mesh boxes(Random& random) {
  Mesh mesh;
  for (uint32_t i = 1 + random.below(20); i > 0; --i) {
    const Point low = integer_point(random, 4);
    const Point size{static_cast<float>(random.between(0, 3)),
                     static_cast<float>(random.between(0, 3)),
                     static_cast<float>(random.between(0, 3))};
    const auto first = static_cast<uint32_t>(mesh.vertices.size());
    for (uint32_t k = 0; k < 8; ++k) {
      mesh.vertices.push_back({low.x + (k & 1 ? size.x : 0.0f), low.y + (k & 2 ? size.y : 0.0f),
                               low.z + (k & 4 ? size.z : 0.0f)});
    }
    const uint32_t faces[6][4] = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4},
                                  {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
    for (const auto& face : faces) {
      mesh.triangles.push_back({first + face[0], first + face[1], first + face[2]});
      mesh.triangles.push_back({first + face[0], first + face[2], first + face[3]});
    }
  }
  return mesh;
}

Mesh plane_through_origin(Random& random) {
  Mesh mesh;
  const Point p = integer_point(random, 4), q = integer_point(random, 4);
  const auto at = [&] {
    const auto s = static_cast<float>(random.between(-8, 8));
    const auto t = static_cast<float>(random.between(-8, 8));
    return p * s + q * t;
  };
  for (uint32_t i = some_count(random); i > 0; --i) add_triangle(mesh, at);
  return mesh;
}

Mesh greatest(Random& random) {
  Mesh mesh;
  add_soup(mesh, random, some_count(random), 0x1p59f, 0x1p59f);
  for (Point& p : mesh.vertices) {
    if (random.one_in(6)) p[random.between(0, 2)] = random.one_in(2) ? 0x1p60f : -0x1p60f;
  }
  return mesh;
}

Mesh denormal(Random& random) {
  Mesh mesh;
  const float size = random.power_of_two(-148, -120);
  add_soup(mesh, random, some_count(random), size, size);
  return mesh;
}

/// Sizes at which distances become denormal only with a long direction.
Mesh very_small(Random& random) {
  Mesh mesh;
  const float size = random.power_of_two(-90, -30);
  add_soup(mesh, random, some_count(random), size, size);
  return mesh;
}

/// Planes one behind the other, most of them pairwise equal: many hits at one distance.
Mesh stacked(Random& random) {
  Mesh mesh;
  for (uint32_t i = some_count(random); i > 0; --i) {
    const auto z = static_cast<float>(random.between(0, 3));
    const auto shift = static_cast<float>(random.between(-1, 1));
    mesh.add({-2 + shift, -2, z}, {2 + shift, -2, z}, {shift, 2, z});
  }
  return mesh;
}

Mesh far_clusters(Random& random) {
  Mesh mesh;
  for (uint32_t i = 1 + random.below(6); i > 0; --i) {
    const auto first = mesh.vertices.size();
    add_soup(mesh, random, 1 + random.below(30), 1.0f, 0.5f);
    const Point at = random_point(random, random.power_of_two(4, 22));
    for (size_t k = first; k < mesh.vertices.size(); ++k) mesh.vertices[k] = mesh.vertices[k] + at;
  }
  return mesh;
}

/// One large triangle and dust: the boxes of a tree as unequal as can be.
Mesh giant_and_dust(Random& random) {
  Mesh mesh;
  add_soup(mesh, random, some_count(random), 1.0f, 0x1p-8f);
  mesh.add({-1e6f, -1e6f, 0.1f}, {2e6f, -1e6f, 0.1f}, {0.0f, 2e6f, -0.1f});
  return mesh;
}

/// Points that differ by single units in the last place.
Mesh last_places(Random& random) {
  Mesh mesh;
  const Point at = random_point(random, random.power_of_two(0, 10));
  const auto near = [&] {
    Point p = at;
    for (int axis = 0; axis < 3; ++axis) {
      for (int step = random.between(0, 4); step > 0; --step) {
        p[axis] = std::nextafter(p[axis], random.one_in(2) ? kInfinity : -kInfinity);
      }
    }
    return p;
  };
  for (uint32_t i = some_count(random); i > 0; --i) add_triangle(mesh, near);
  return mesh;
}

using Maker = Mesh (*)(Random&);
struct Kind {
  const char* name;
  Maker make;
};
constexpr Kind kKinds[] = {{"soup", soup},
                           {"slivers", slivers},
                           {"coplanar", coplanar},
                           {"duplicated", duplicated},
                           {"huge and tiny", huge_and_tiny},
                           {"bad vertices", with_bad_vertices},
                           {"few", few},
                           {"identical", identical},
                           {"degenerate", degenerate},
                           {"shared grid", shared_grid},
                           {"fan", fan},
                           {"boxes", boxes},
                           {"plane through the origin", plane_through_origin},
                           {"greatest", greatest},
                           {"denormal", denormal},
                           {"very small", very_small},
                           {"stacked", stacked},
                           {"far clusters", far_clusters},
                           {"giant and dust", giant_and_dust},
                           {"last places", last_places}};

}  // namespace

Scene adversarial_scene(uint32_t index, uint64_t seed) {
  Random random(seed, index);
  const Kind& kind = kKinds[index % std::size(kKinds)];
  Scene scene{kind.name + (" #" + std::to_string(index)), {}};
  const uint32_t mesh_count = random.one_in(3) ? 2 + random.below(3) : 1;
  for (uint32_t i = 0; i < mesh_count; ++i) {
    scene.meshes.push_back(kind.make(random));
    if (mesh_count > 1 && random.one_in(2)) scene.meshes.back().mask = 1u << random.below(3);
  }
  // The same mesh twice: two geometries whose hits are all equal but for their number.
  if (mesh_count > 1 && random.one_in(3)) scene.meshes.back() = scene.meshes.front();
  return scene;
}

}  // namespace kiwami_tests
