// SPDX-License-Identifier: Apache-2.0
// Shapes, triangles with opacity micromaps and moving triangles below nested instances, of which
// one moves: the transforms and origins are such that nothing is rounded on the way in, so the
// answers of every call are those of the innermost scene to the ray as it is there, to the bit, on
// every ISA and width.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <cstring>

#include "parity/all_answers.h"
#include "parity/committed_tree.h"
#include "parity/kernel_tables.h"
#include "support/environment.h"
#include "support/random.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

using Matrix34 = std::array<float, 12>;

/// Of a scene with a piece of each kind.
struct Pieces {
  std::vector<float> spheres, discs, normals, curves;
  Mesh leaves, moving;
  std::vector<unsigned char> maps;
  std::vector<Point> moved;

  explicit Pieces(Random& random) {
    const auto add_point = [&](std::vector<float>& points) {
      for (int k = 0; k < 3; ++k) points.push_back(2.0f * random.symmetric());
      points.push_back(0.05f + 0.3f * random.unit());
    };
    for (int i = 0; i < 20; ++i) {
      add_point(spheres);
      add_point(discs);
      for (int k = 0; k < 3; ++k) normals.push_back(random.symmetric() + 0.01f);
      add_point(curves);
      for (Mesh* mesh : {&leaves, &moving}) {
        const auto point = [&] {
          return Point{2.0f * random.symmetric(), 2.0f * random.symmetric(),
                       2.0f * random.symmetric()};
        };
        mesh->add(point(), point(), point());
      }
      // A map of two states of level 2 each.
      for (int k = 0; k < 2; ++k) maps.push_back(static_cast<unsigned char>(random.bits()));
    }
    for (const Point& vertex : moving.vertices) {
      moved.push_back(vertex + Point{random.symmetric(), random.symmetric(), random.symmetric()});
    }
  }

  void attach_to(kiwami_device* device, kiwami_scene* scene) const {
    const auto attach = [&](kiwami_geometry* geometry) {
      check(kiwami_scene_attach(scene, geometry, nullptr));
      kiwami_geometry_release(geometry);
    };
    kiwami_geometry* geometry = nullptr;
    kiwami_spheres_desc of_spheres;
    check(kiwami_spheres_desc_init(&of_spheres, sizeof of_spheres));
    of_spheres.points = spheres.data();
    of_spheres.sphere_count = spheres.size() / 4;
    check(kiwami_spheres_create(device, &of_spheres, &geometry));
    attach(geometry);
    kiwami_discs_desc of_discs;
    check(kiwami_discs_desc_init(&of_discs, sizeof of_discs));
    of_discs.points = discs.data();
    of_discs.normals = normals.data();
    of_discs.disc_count = discs.size() / 4;
    check(kiwami_discs_create(device, &of_discs, &geometry));
    attach(geometry);
    kiwami_curves_desc of_curves;
    check(kiwami_curves_desc_init(&of_curves, sizeof of_curves));
    of_curves.points = curves.data();
    of_curves.point_count = curves.size() / 4;
    of_curves.segment_count = of_curves.point_count - 1;
    check(kiwami_curves_create(device, &of_curves, &geometry));
    attach(geometry);
    attach(make_leaves(device));
    attach(make_moving(device));
  }

 private:
  kiwami_geometry* make_leaves(kiwami_device* device) const {
    kiwami_triangle_mesh_desc desc;
    check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = leaves.vertices.data();
    desc.vertex_count = leaves.vertices.size();
    desc.triangle_count = leaves.triangles.size();
    kiwami_geometry* geometry = nullptr;
    check(kiwami_triangle_mesh_create(device, &desc, &geometry));
    kiwami_opacity_desc opacity;
    check(kiwami_opacity_desc_init(&opacity, sizeof opacity));
    opacity.level = 2;
    opacity.maps = maps.data();
    opacity.map_count = maps.size() / 2;
    check(kiwami_triangle_mesh_set_opacity(geometry, &opacity));
    return geometry;
  }
  kiwami_geometry* make_moving(kiwami_device* device) const {
    std::vector<Point> vertices = moving.vertices;
    vertices.insert(vertices.end(), moved.begin(), moved.end());
    kiwami_moving_mesh_desc desc;
    check(kiwami_moving_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = vertices.data();
    desc.vertex_count = moving.vertices.size();
    desc.triangle_count = moving.triangles.size();
    kiwami_geometry* geometry = nullptr;
    check(kiwami_moving_mesh_create(device, &desc, &geometry));
    return geometry;
  }
};

/// A permutation of the axes with signs, times a power of two, and a translation by eighths.
Matrix34 random_exact(Random& random) {
  Matrix34 matrix{};
  const uint32_t turn = random.below(3);
  const bool is_swapped = random.one_in(2);
  const float scale = random.power_of_two(-1, 1);
  for (uint32_t row = 0; row < 3; ++row) {
    const uint32_t column = (is_swapped && row != 0 ? 3 - row : row) + turn;
    matrix[4 * row + column % 3] = random.one_in(2) ? scale : -scale;
    matrix[4 * row + 3] = static_cast<float>(random.between(-8, 8)) * 0.125f;
  }
  return matrix;
}

/// By the inverse of an exact matrix.
Point carried_in(const Matrix34& matrix, Point outer, bool is_direction) {
  Point inner{0, 0, 0};
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 3; ++column) {
      const auto at = static_cast<size_t>(4 * row);
      const float entry = matrix[at + static_cast<size_t>(column)];
      if (entry == 0.0f) continue;
      inner[column] = (outer[row] - (is_direction ? 0.0f : matrix[at + 3])) / entry;
    }
  }
  return inner;
}

/// A scene of two instances of another: of the first no ray sees anything.
SceneHandle outer_scene(kiwami_device* device, kiwami_scene* shown, uint32_t width,
                        const Matrix34& matrix, bool is_moving) {
  const std::vector<Matrix34> matrices(is_moving ? 4 : 2, matrix);
  const uint32_t masks[] = {0, ~0u};
  kiwami_geometry* geometry = nullptr;
  if (is_moving) {
    kiwami_moving_instances_desc desc;
    check(kiwami_moving_instances_desc_init(&desc, sizeof desc));
    desc.scenes = &shown;
    desc.scene_count = 1;
    desc.transforms = matrices.data();
    desc.count = 2;
    desc.masks = masks;
    check(kiwami_moving_instances_create(device, &desc, &geometry));
  } else {
    kiwami_instances_desc desc;
    check(kiwami_instances_desc_init(&desc, sizeof desc));
    desc.scenes = &shown;
    desc.scene_count = 1;
    desc.transforms = matrices.data();
    desc.count = 2;
    desc.masks = masks;
    check(kiwami_instances_create(device, &desc, &geometry));
  }
  BuildOptions options;
  options.width = width;
  SceneHandle scene = make_scene(device, Scene{}, options);
  check(kiwami_scene_attach(scene.get(), geometry, nullptr));
  kiwami_geometry_release(geometry);
  check(kiwami_scene_commit(scene.get()));
  return scene;
}

/// From a point of a grid, which nothing rounds on its way in, to about an inner point.
kiwami_ray grid_ray(const std::vector<Matrix34>& matrices, Random& random) {
  Point origin{}, target{};
  for (int k = 0; k < 3; ++k) {
    origin[k] = static_cast<float>(random.between(-1024, 1024)) * 0x1p-7f;
    target[k] = 2.0f * random.symmetric();
  }
  for (const Matrix34& matrix : matrices) {
    Point outer{};
    for (int row = 0; row < 3; ++row) {
      const float* entries = &matrix[static_cast<size_t>(4 * row)];
      outer[row] =
          entries[0] * target.x + entries[1] * target.y + entries[2] * target.z + entries[3];
    }
    target = outer;
  }
  kiwami_ray ray = ray_from(origin, target - origin);
  constexpr float kTimes[] = {0.0f, 0.25f, 0.5f, 1.0f};
  ray.time = kTimes[random.below(4)];
  if (random.one_in(8)) ray.tmax = random.unit() * 3.0f;
  if (random.one_in(8)) ray.flags = KIWAMI_RAY_CULL_BACK_FACES;
  return ray;
}

/// Without what only an outer scene can say: paths, and the numbers of instances, which are all
/// `number`.
std::vector<NamedAnswers> as_inside(std::vector<NamedAnswers> answers, uint32_t number) {
  std::vector<NamedAnswers> inside;
  for (NamedAnswers& answer : answers) {
    if (answer.call.ends_with("paths")) continue;
    if (answer.record_size == sizeof(kiwami_hit)) {
      for (size_t at = 0; at < answer.bytes.size(); at += sizeof(kiwami_hit)) {
        kiwami_hit hit;
        std::memcpy(&hit, &answer.bytes[at], sizeof hit);
        if (hit.primitive_id == KIWAMI_INVALID_ID) continue;
        EXPECT_EQ(hit.instance_id, number);
        hit.instance_id = KIWAMI_INVALID_ID;
        std::memcpy(&answer.bytes[at], &hit, sizeof hit);
      }
    }
    inside.push_back(std::move(answer));
  }
  return inside;
}

TEST(NestedKinds, AreMetAsInTheirOwnScene) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  const uint64_t scene_count = case_budget(4);
  const size_t ray_count = ray_budget(1200) / scene_count + 1;
  size_t hits = 0;
  for (uint64_t number = 0; number < scene_count; ++number) {
    Random random(seed(), 700 + number);
    const Pieces pieces(random);
    std::vector<Matrix34> matrices;
    for (int level = 0; level < 4; ++level) matrices.push_back(random_exact(random));
    std::vector<kiwami_ray> rays, inner_rays;
    for (size_t i = 0; i < ray_count; ++i) {
      rays.push_back(grid_ray(matrices, random));
      kiwami_ray ray = rays.back();
      Point origin{ray.origin_x, ray.origin_y, ray.origin_z};
      Point direction{ray.direction_x, ray.direction_y, ray.direction_z};
      for (auto matrix = matrices.rbegin(); matrix != matrices.rend(); ++matrix) {
        origin = carried_in(*matrix, origin, false);
        direction = carried_in(*matrix, direction, true);
      }
      kiwami_ray inner = ray_from(origin, direction);
      inner.tmin = ray.tmin;
      inner.tmax = ray.tmax;
      inner.time = ray.time;
      inner.flags = ray.flags;
      inner_rays.push_back(inner);
    }
    std::vector<NamedAnswers> reference;
    for (const NamedKernels& kernels : all_kernels()) {
      const DeviceHandle device = make_device(kernels.isa, 1);
      BuildOptions options;
      options.width = kernels.width;
      std::vector<SceneHandle> scenes;
      scenes.push_back(make_scene(device.get(), Scene{}, options));
      pieces.attach_to(device.get(), scenes.back().get());
      check(kiwami_scene_commit(scenes.back().get()));
      const std::vector<NamedAnswers> inside =
          as_inside(all_answers(scenes.back().get(), inner_rays), KIWAMI_INVALID_ID);
      if (reference.empty()) reference = inside;
      ASSERT_EQ(difference(inside, reference), "") << kernels.name << ", KIWAMI_SEED=" << seed();
      for (size_t level = 0; level < matrices.size(); ++level) {
        scenes.push_back(outer_scene(device.get(), scenes.back().get(), kernels.width,
                                     matrices[level], level == 1));
      }
      ASSERT_EQ(difference(as_inside(all_answers(scenes.back().get(), rays), 1), reference), "")
          << kernels.name << ", scene " << number << ", KIWAMI_SEED=" << seed();
      kiwami::TraversalCounters counters{};
      run_general<kiwami_hit>(kernels_of(scenes.back().get()).general.closest_hit_counted,
                              view_of(scenes.back().get()), rays, counters);
      EXPECT_EQ(counters.margin_violations, 0u) << kernels.name;
    }
    hits += hit_count(reference);
  }
  std::printf("%zu of %zu rays hit\n", hits, scene_count * ray_count);
  EXPECT_GT(hits, scene_count * ray_count / 2);
}

}  // namespace
}  // namespace kiwami_tests
