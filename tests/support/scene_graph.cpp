// SPDX-License-Identifier: Apache-2.0
#include "support/scene_graph.h"

#include <algorithm>
#include <cmath>
#include <memory>

namespace kiwami_tests {
namespace {

using Matrix = std::array<std::array<double, 4>, 3>;

constexpr Matrix kIdentity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

Matrix widened(const Matrix34& m) {
  Matrix wide;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t k = 0; k < 4; ++k) wide[row][k] = m[row * 4 + k];
  }
  return wide;
}

/// First b, then a.
Matrix product(const Matrix& a, const Matrix& b) {
  Matrix result;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t k = 0; k < 4; ++k) {
      result[row][k] = a[row][0] * b[0][k] + a[row][1] * b[1][k] + a[row][2] * b[2][k];
    }
    result[row][3] += a[row][3];
  }
  return result;
}

double norm(const Matrix& m) {
  double greatest = 0;
  for (const auto& row : m) {
    greatest = std::max(greatest, std::fabs(row[0]) + std::fabs(row[1]) + std::fabs(row[2]));
  }
  return greatest;
}

Matrix inverse_linear(const Matrix& m) {
  Matrix inverse{};
  double determinant = 0;
  for (size_t i = 0; i < 3; ++i) {
    for (size_t j = 0; j < 3; ++j) {
      const size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
      inverse[j][i] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
    }
    determinant +=
        m[0][i] * (m[1][(i + 1) % 3] * m[2][(i + 2) % 3] - m[1][(i + 2) % 3] * m[2][(i + 1) % 3]);
  }
  for (auto& row : inverse) {
    for (double& entry : row) entry /= determinant;
  }
  return inverse;
}

Point random_point(Random& random, float size) {
  return {random.symmetric() * size, random.symmetric() * size, random.symmetric() * size};
}

Mesh random_mesh(Random& random, uint32_t count) {
  Mesh mesh;
  if (random.one_in(4)) mesh.mask = random.bits() | 1u;
  for (uint32_t i = 0; i < count; ++i) {
    const Point centre = random_point(random, 1.0f);
    mesh.add(centre + random_point(random, 0.5f), centre + random_point(random, 0.5f),
             centre + random_point(random, 0.5f));
  }
  // A flat box is no thicker than the rounding of what is in it.
  if (random.one_in(2)) {
    const int axis = random.between(0, 2);
    const float height = random.symmetric();
    for (Point& vertex : mesh.vertices) vertex[axis] = height;
  }
  return mesh;
}

/// A rotation by a random quaternion, a scale of each axis, sometimes a mirror, a shear or none of
/// it, and a translation.
Matrix34 random_transform(Random& random) {
  double q[4], length = 0;
  do {
    length = 0;
    for (double& component : q) {
      component = random.symmetric();
      length += component * component;
    }
  } while (length < 0.01 || length > 1);
  const double s = 2.0 / length;
  const double r[3][3] = {{1 - s * (q[2] * q[2] + q[3] * q[3]), s * (q[1] * q[2] - q[3] * q[0]),
                           s * (q[1] * q[3] + q[2] * q[0])},
                          {s * (q[1] * q[2] + q[3] * q[0]), 1 - s * (q[1] * q[1] + q[3] * q[3]),
                           s * (q[2] * q[3] - q[1] * q[0])},
                          {s * (q[1] * q[3] - q[2] * q[0]), s * (q[2] * q[3] + q[1] * q[0]),
                           1 - s * (q[1] * q[1] + q[2] * q[2])}};
  const bool is_plain = random.one_in(2);
  const float shear = random.one_in(3) ? random.symmetric() * 0.3f : 0.0f;
  Matrix34 m{};
  for (size_t k = 0; k < 3; ++k) {
    float scale = is_plain ? 1.0f : 0.7f + 0.6f * random.unit();
    if (random.one_in(3)) scale = -scale;
    for (size_t row = 0; row < 3; ++row) {
      m[row * 4 + k] = static_cast<float>(is_plain ? (row == k ? 1 : 0) : r[row][k]) * scale;
    }
  }
  for (size_t row = 0; row < 3; ++row) {
    m[row * 4] += shear * m[row * 4 + 1];
    m[row * 4 + 3] = random.symmetric() * 2.0f;
  }
  return m;
}

void add_triangles(const SceneGraph& graph, size_t scene_number, const Matrix& to_world,
                   uint32_t mask, std::vector<uint32_t>& path,
                   std::vector<WorldTriangle>& triangles) {
  const GraphScene& scene = graph.scenes[scene_number];
  const double condition = norm(to_world) * norm(inverse_linear(to_world));
  for (uint32_t geometry = 0; geometry < scene.meshes.size(); ++geometry) {
    const Mesh& mesh = scene.meshes[geometry];
    for (uint32_t i = 0; i < mesh.triangles.size(); ++i) {
      WorldTriangle triangle{{}, path, geometry, i, mask & mesh.mask, condition};
      const auto corners = mesh.corners(i);
      for (size_t k = 0; k < 3; ++k) {
        for (size_t row = 0; row < 3; ++row) {
          const auto& m = to_world[row];
          triangle.corner[k][row] =
              m[0] * corners[k].x + m[1] * corners[k].y + m[2] * corners[k].z + m[3];
        }
      }
      triangles.push_back(triangle);
    }
  }
  uint32_t number = 0;
  for (const InstanceArray& array : scene.arrays) {
    for (size_t i = 0; i < array.shown.size(); ++i) {
      path.push_back(number++);
      add_triangles(graph, array.shown[i], product(to_world, widened(array.transforms[i])),
                    mask & array.mask & array.masks[i], path, triangles);
      path.pop_back();
    }
  }
}

size_t triangle_count(const std::vector<size_t>& counts, const GraphScene& scene) {
  size_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.triangles.size();
  for (const InstanceArray& array : scene.arrays) {
    for (const uint32_t shown : array.shown) count += counts[shown];
  }
  return count;
}

void attach(const SceneHandle& scene, kiwami_geometry* geometry) {
  const kiwami_result result = kiwami_scene_attach(scene.get(), geometry, nullptr);
  kiwami_geometry_release(geometry);
  check(result);
}

kiwami_geometry* make_geometry(kiwami_device* device, const Mesh& mesh) {
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertices.size();
  desc.indices = mesh.triangles.data();
  desc.triangle_count = mesh.triangles.size();
  desc.mask = mesh.mask;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_triangle_mesh_create(device, &desc, &geometry));
  return geometry;
}

kiwami_geometry* make_geometry(kiwami_device* device, const Mesh& mesh,
                               const std::vector<Point>& moved) {
  std::vector<Point> vertices = mesh.vertices;
  vertices.insert(vertices.end(), moved.begin(), moved.end());
  kiwami_moving_mesh_desc desc;
  check(kiwami_moving_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = vertices.data();
  desc.vertex_count = moved.size();
  desc.indices = mesh.triangles.data();
  desc.triangle_count = mesh.triangles.size();
  desc.mask = mesh.mask;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_moving_mesh_create(device, &desc, &geometry));
  return geometry;
}

kiwami_geometry* make_moving_geometry(kiwami_device* device, const InstanceArray& array,
                                      const std::vector<kiwami_scene*>& scenes) {
  kiwami_moving_instances_desc desc;
  check(kiwami_moving_instances_desc_init(&desc, sizeof desc));
  desc.scenes = scenes.data();
  desc.scene_count = scenes.size();
  desc.scene_indices = array.shown.data();
  desc.transforms = array.steps.data();
  desc.count = array.shown.size();
  desc.masks = array.masks.data();
  desc.mask = array.mask;
  desc.format = array.format;
  desc.step_count = array.step_count;
  desc.time_begin = array.begin;
  desc.time_end = array.end;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_moving_instances_create(device, &desc, &geometry));
  return geometry;
}

kiwami_geometry* make_geometry(kiwami_device* device, const InstanceArray& array,
                               const std::vector<SceneHandle>& scenes) {
  std::vector<kiwami_scene*> handles;
  for (const SceneHandle& scene : scenes) handles.push_back(scene.get());
  if (array.step_count > 1) return make_moving_geometry(device, array, handles);
  kiwami_instances_desc desc;
  check(kiwami_instances_desc_init(&desc, sizeof desc));
  desc.scenes = handles.data();
  desc.scene_count = handles.size();
  desc.scene_indices = array.shown.data();
  desc.transforms = array.transforms.data();
  desc.count = array.shown.size();
  desc.masks = array.masks.data();
  desc.mask = array.mask;
  kiwami_geometry* geometry = nullptr;
  check(kiwami_instances_create(device, &desc, &geometry));
  return geometry;
}

/// A step that is near the matrix, or another one.
Matrix34 random_step(const Matrix34& before, Random& random) {
  if (random.one_in(3)) return random_transform(random);
  Matrix34 step = before;
  for (float& entry : step) entry += 0.2f * random.symmetric();
  return step;
}

std::array<float, 16> random_quaternion_step(Random& random) {
  const auto scale = [&] {
    return (random.one_in(4) ? -1.0f : 1.0f) * (0.7f + 0.6f * random.unit());
  };
  const bool is_plain = random.one_in(2);
  std::array<float, 16> step{};
  for (size_t i = 0; i < 3; ++i) {
    step[i] = is_plain ? 1.0f : scale();
    if (!is_plain) step[3 + i] = 0.3f * random.symmetric();
    if (!is_plain) step[6 + i] = random.symmetric();
    step[13 + i] = 2.0f * random.symmetric();
  }
  for (size_t i = 0; i < 4; ++i) step[9 + i] = random.symmetric() + (i == 0 ? 0.01f : 0.0f);
  return step;
}

void set_in_motion(InstanceArray& array, Random& random) {
  constexpr uint32_t kCounts[] = {2, 2, 3, 5};
  array.step_count = kCounts[random.below(4)];
  array.format = random.one_in(2) ? KIWAMI_TRANSFORM_MATRIX : KIWAMI_TRANSFORM_QUATERNION;
  if (random.one_in(3)) array.begin = -0.5f * random.unit();
  if (random.one_in(3)) array.end = 0.4f + random.unit();
  for (const Matrix34& transform : array.transforms) {
    Matrix34 step = transform;
    for (uint32_t k = 0; k < array.step_count; ++k) {
      if (array.format == KIWAMI_TRANSFORM_MATRIX) {
        if (k != 0) step = random_step(step, random);
        array.steps.insert(array.steps.end(), step.begin(), step.end());
      } else {
        const std::array<float, 16> turned = random_quaternion_step(random);
        array.steps.insert(array.steps.end(), turned.begin(), turned.end());
      }
    }
  }
}

/// As the documentation of kiwami_moving_mesh_desc places a time; false: outside.
bool place_of(const InstanceArray& array, float time, size_t& step, float& fraction) {
  if (!(array.begin <= time && time <= array.end)) return false;
  const auto n = static_cast<float>(array.step_count - 1);
  const float s = (time - array.begin) / (array.end - array.begin) * n;
  step = static_cast<size_t>(std::fmin(std::floor(s), n - 1.0f));
  fraction = s - static_cast<float>(step);
  return true;
}

Matrix34 transform_at(const InstanceArray& array, const kiwami_geometry* made, size_t i, float time,
                      size_t step, float fraction) {
  Matrix34 transform;
  if (array.format != KIWAMI_TRANSFORM_MATRIX) {
    check(kiwami_instances_transform(made, i, time, transform.data()));
    return transform;
  }
  const float* a = &array.steps[(i * array.step_count + step) * 12];
  for (size_t k = 0; k < 12; ++k) {
    const float of_a = (1.0f - fraction) * a[k], of_b = fraction * a[12 + k];
    transform[k] = of_a + of_b;
  }
  return transform;
}

bool is_singular(const Matrix34& transform) {
  const Matrix matrix = widened(transform);
  // At least 1, but for NaN, of which norms know nothing.
  const double condition = norm(matrix) * norm(inverse_linear(matrix));
  return !(0.5 <= condition && condition <= 0x1p20);
}

InstanceArray frozen(const InstanceArray& array, kiwami_device* device,
                     const std::vector<SceneHandle>& scenes, float time) {
  InstanceArray still = array;
  if (array.step_count == 1) return still;
  still.step_count = 1;
  const std::unique_ptr<kiwami_geometry, Release> made(make_geometry(device, array, scenes));
  size_t step = 0;
  float fraction = 0.0f;
  const bool is_there = place_of(array, time, step, fraction);
  for (size_t i = 0; i < array.shown.size(); ++i) {
    Matrix34 then = array.transforms[i];
    if (is_there) then = transform_at(array, made.get(), i, time, step, fraction);
    if (is_there && !is_singular(then)) {
      still.transforms[i] = then;
    } else {
      still.masks[i] = 0;
    }
  }
  return still;
}

}  // namespace

SceneGraph in_motion(SceneGraph graph, Random& random) {
  for (GraphScene& scene : graph.scenes) {
    scene.moved.resize(scene.meshes.size());
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
      if (!random.one_in(3)) continue;
      const Point way = random_point(random, 1.0f);
      for (const Point& vertex : scene.meshes[i].vertices) {
        scene.moved[i].push_back(vertex + way + random_point(random, 0.2f));
      }
    }
    for (InstanceArray& array : scene.arrays) {
      if (!random.one_in(4)) set_in_motion(array, random);
    }
  }
  return graph;
}

SceneGraph frozen(const SceneGraph& graph, kiwami_device* device,
                  const std::vector<SceneHandle>& scenes, float time) {
  SceneGraph still = graph;
  for (GraphScene& scene : still.scenes) {
    for (size_t i = 0; i < scene.moved.size(); ++i) {
      if (scene.moved[i].empty()) continue;
      Mesh& mesh = scene.meshes[i];
      if (!(0.0f <= time && time <= 1.0f)) {
        mesh.triangles.clear();
        continue;
      }
      for (size_t k = 0; k < mesh.vertices.size(); ++k) {
        for (int axis = 0; axis < 3; ++axis) {
          const float a = (1.0f - time) * mesh.vertices[k][axis];
          const float b = time * scene.moved[i][k][axis];
          mesh.vertices[k][axis] = a + b;
        }
      }
    }
    scene.moved.clear();
    for (InstanceArray& array : scene.arrays) array = frozen(array, device, scenes, time);
  }
  return still;
}

uint32_t SceneGraph::depth() const {
  std::vector<uint32_t> depths;
  for (const GraphScene& scene : scenes) {
    uint32_t depth = 0;
    for (const InstanceArray& array : scene.arrays) {
      for (const uint32_t shown : array.shown) depth = std::max(depth, depths[shown] + 1);
    }
    depths.push_back(depth);
  }
  return depths.back();
}

SceneGraph random_scene_graph(Random& random, uint32_t depth, size_t max_triangles) {
  SceneGraph graph;
  std::vector<size_t> counts;
  for (uint32_t level = 0; level <= depth; ++level) {
    GraphScene scene;
    if (level == 0 || random.one_in(3)) {
      for (uint32_t i = 1 + random.below(2); i != 0; --i) {
        scene.meshes.push_back(random_mesh(random, 1 + random.below(12)));
      }
    }
    for (uint32_t arrays = level == 0 ? 0 : 1 + random.below(2); arrays != 0; --arrays) {
      InstanceArray array;
      if (random.one_in(4)) array.mask = random.bits() | 1u;
      for (uint32_t i = 1 + random.below(4); i != 0; --i) {
        // The first one makes the path as long as it should be.
        const bool is_first = scene.arrays.empty() && array.shown.empty();
        const uint32_t shown = is_first ? level - 1 : random.below(level);
        if (!is_first && triangle_count(counts, scene) + counts[shown] > max_triangles) {
          continue;
        }
        array.shown.push_back(shown);
        array.transforms.push_back(random_transform(random));
        array.masks.push_back(random.one_in(4) ? random.bits() | 1u : ~0u);
      }
      if (!array.shown.empty()) scene.arrays.push_back(array);
    }
    graph.scenes.push_back(scene);
    counts.push_back(triangle_count(counts, scene));
  }
  return graph;
}

std::vector<WorldTriangle> flatten(const SceneGraph& graph) {
  std::vector<WorldTriangle> triangles;
  std::vector<uint32_t> path;
  add_triangles(graph, graph.scenes.size() - 1, kIdentity, ~0u, path, triangles);
  return triangles;
}

std::vector<SceneHandle> build(kiwami_device* device, const SceneGraph& graph, uint32_t width,
                               uint32_t rebraid) {
  std::vector<SceneHandle> scenes;
  for (const GraphScene& scene : graph.scenes) {
    kiwami_scene* handle = nullptr;
    check(kiwami_scene_create(device, &handle));
    SceneHandle made(handle);
    check(kiwami_scene_set_parameter(handle, KIWAMI_PARAMETER_BVH_WIDTH, width));
    check(kiwami_scene_set_parameter(handle, KIWAMI_PARAMETER_VALIDATE_BUILD, 1));
    check(kiwami_scene_set_parameter(handle, KIWAMI_PARAMETER_REBRAID, rebraid));
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
      const bool is_moving = i < scene.moved.size() && !scene.moved[i].empty();
      attach(made, is_moving ? make_geometry(device, scene.meshes[i], scene.moved[i])
                             : make_geometry(device, scene.meshes[i]));
    }
    for (const InstanceArray& array : scene.arrays) {
      attach(made, make_geometry(device, array, scenes));
    }
    check(kiwami_scene_commit(handle));
    scenes.push_back(std::move(made));
  }
  return scenes;
}

}  // namespace kiwami_tests
