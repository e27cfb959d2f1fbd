// SPDX-License-Identifier: Apache-2.0
#include "scene/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scene/random.h"

namespace kiwami::tools {
namespace {

constexpr float kReach = 0.02f;           // of the diagonal
constexpr float kGreatestTurn = 0.6283f;  // a tenth of a turn
constexpr float kWaves = 12.0f;           // along the diagonal, times two pi

/// The length of the diagonal of the box of finite points, from the flattened meshes.
float diagonal_of(const SceneFile& scene) {
  float low[3], high[3];
  std::fill_n(low, 3, std::numeric_limits<float>::max());
  std::fill_n(high, 3, -std::numeric_limits<float>::max());
  const SceneFile flat = flatten(scene);
  for (const Mesh& mesh : flat.meshes) {
    for (size_t i = 0; i < mesh.vertices.size(); ++i) {
      if (!std::isfinite(mesh.vertices[i])) continue;
      low[i % 3] = std::min(low[i % 3], mesh.vertices[i]);
      high[i % 3] = std::max(high[i % 3], mesh.vertices[i]);
    }
  }
  return length(Vec3{high[0] - low[0], high[1] - low[1], high[2] - low[2]});
}

void move_meshes(SceneFile& scene) {
  const float diagonal = diagonal_of(scene);
  const float frequency = kWaves / diagonal;
  for (Mesh& mesh : scene.meshes) {
    mesh.moved = mesh.vertices;
    for (size_t i = 0; i + 2 < mesh.vertices.size(); i += 3) {
      for (size_t axis = 0; axis < 3; ++axis) {
        // Each coordinate by the two others, so that what lies along an axis does not shrink.
        const float phase =
            frequency * (mesh.vertices[i + (axis + 1) % 3] + mesh.vertices[i + (axis + 2) % 3]);
        mesh.moved[i + axis] += kReach / std::sqrt(3.0f) * diagonal * std::sin(phase);
      }
    }
  }
}

std::array<float, 12> turned(const std::array<float, 12>& m, Vec3 axis, float angle, Vec3 shift) {
  // Rodrigues' formula.
  const float c = std::cos(angle), s = std::sin(angle), d = 1.0f - c;
  const float r[3][3] = {
      {c + axis.x * axis.x * d, axis.x * axis.y * d - axis.z * s, axis.x * axis.z * d + axis.y * s},
      {axis.y * axis.x * d + axis.z * s, c + axis.y * axis.y * d, axis.y * axis.z * d - axis.x * s},
      {axis.z * axis.x * d - axis.y * s, axis.z * axis.y * d + axis.x * s,
       c + axis.z * axis.z * d}};
  std::array<float, 12> moved = m;
  for (size_t row = 0; row < 3; ++row) {
    for (size_t k = 0; k < 3; ++k) {
      moved[4 * row + k] = r[row][0] * m[k] + r[row][1] * m[4 + k] + r[row][2] * m[8 + k];
    }
    moved[4 * row + 3] += shift[static_cast<int>(row)];
  }
  return moved;
}

void move_instances(SceneFile& scene) {
  if (scene.instances.empty()) throw SceneError("there are no instances to move");
  const float reach = kReach * diagonal_of(scene);
  Random random(17);
  const auto symmetric = [&] { return random.uniform(-1.0f, 1.0f); };
  for (const Instance& instance : scene.instances) {
    const float x = symmetric(), y = symmetric(), z = symmetric() + 1e-3f;
    const Vec3 direction = normalize(Vec3{x, y, z});
    const float angle = kGreatestTurn * symmetric();
    const float distance = reach * random.uniform();
    scene.moved_transforms.push_back(
        turned(instance.transform, {0, 1, 0}, angle, direction * distance));
  }
}

void move_to_keyframe(SceneFile& scene, const std::string& path) {
  const SceneFile end = flatten(load_scene(path));
  bool is_same = scene.instances.empty() && scene.meshes.size() == end.meshes.size();
  for (size_t i = 0; is_same && i < scene.meshes.size(); ++i) {
    is_same = scene.meshes[i].indices == end.meshes[i].indices &&
              scene.meshes[i].vertices.size() == end.meshes[i].vertices.size();
    scene.meshes[i].moved = end.meshes[i].vertices;
  }
  if (!is_same) throw SceneError("'" + path + "' has other triangles than the scene that moves");
}

}  // namespace

void set_in_motion(SceneFile& scene, const std::string& way) {
  if (way == "meshes") {
    move_meshes(scene);
  } else if (way == "instances") {
    move_instances(scene);
  } else {
    move_to_keyframe(scene, way);
  }
}

}  // namespace kiwami::tools
