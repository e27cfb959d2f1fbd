// SPDX-License-Identifier: Apache-2.0
#include "scene/shape_clouds.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "scene/random.h"
#include "scene/vector.h"

namespace kiwami::tools {
namespace {

constexpr float kTurn = 6.2831853f;

void add_point(ShapeCloud& cloud, Vec3 at, float radius) {
  cloud.points.insert(cloud.points.end(), {at.x, at.y, at.z, radius});
}

/// A point of the torus, by its two angles.
Vec3 torus_at(float u, float v) {
  const float thickness = 0.4f + 0.05f * std::sin(7.0f * u) * std::cos(5.0f * v);
  const float ring = 1.0f + thickness * std::cos(v);
  return {ring * std::cos(u), thickness * std::sin(v), ring * std::sin(u)};
}

/// Points as a scanner finds them: spread over the surface, a little off it.
ShapeCloud scan_torus(CloudKind kind, uint32_t count) {
  ShapeCloud cloud{kind, {}, {}, {}};
  Random random(11);
  const float radius = 3.0f / std::sqrt(static_cast<float>(count));
  for (uint32_t i = 0; i < count; ++i) {
    const float u = random.uniform(0.0f, kTurn), v = random.uniform(0.0f, kTurn);
    const Vec3 at = torus_at(u, v);
    const Vec3 normal = normalize(cross(torus_at(u, v + 1e-3f) - at, torus_at(u + 1e-3f, v) - at));
    add_point(cloud, at + normal * (random.uniform(-0.2f, 0.2f) * radius),
              radius * random.uniform(0.7f, 1.3f));
    if (kind == CloudKind::kDiscs) {
      cloud.normals.insert(cloud.normals.end(), {normal.x, normal.y, normal.z});
    }
  }
  return cloud;
}

ShapeCloud fill_box(uint32_t count) {
  ShapeCloud cloud{CloudKind::kSpheres, {}, {}, {}};
  Random random(12);
  const float radius = 0.5f / std::cbrt(static_cast<float>(count));
  for (uint32_t i = 0; i < count; ++i) {
    const Vec3 at = {random.uniform(-1.0f, 1.0f), random.uniform(-1.0f, 1.0f),
                     random.uniform(-1.0f, 1.0f)};
    const float size = random.uniform();
    add_point(cloud, at, radius * (0.2f + 2.0f * size * size * size));
  }
  return cloud;
}

/// Curls on the upper part of a ball, thinner towards their ends.
ShapeCloud grow_hair(uint32_t count) {
  constexpr uint32_t segments = 16;
  ShapeCloud cloud{CloudKind::kCurves, {}, {}, {}};
  Random random(13);
  const uint32_t strands = std::max(1u, count / segments);
  const float thickness = 0.3f / std::sqrt(static_cast<float>(strands));
  for (uint32_t strand = 0; strand < strands; ++strand) {
    const float around = random.uniform(0.0f, kTurn), height = random.uniform(-0.2f, 1.0f);
    const float ring = std::sqrt(1.0f - height * height);
    const Vec3 root = {ring * std::cos(around), height, ring * std::sin(around)};
    const float phase = random.uniform(0.0f, kTurn), curl = random.uniform(0.02f, 0.08f);
    const float reach = random.uniform(0.5f, 1.0f);
    for (uint32_t i = 0; i <= segments; ++i) {
      const float s = static_cast<float>(i) / segments;
      const Vec3 turn = {std::cos(phase + 9.0f * s), 0.0f, std::sin(phase + 9.0f * s)};
      const Vec3 fall = {0.0f, -0.9f * s * s, 0.0f};
      if (i < segments) cloud.indices.push_back(static_cast<uint32_t>(cloud.points.size() / 4));
      add_point(cloud, root * (1.0f + 0.6f * reach * s) + turn * (curl * s) + fall * reach,
                thickness * (1.0f - 0.9f * s));
    }
  }
  return cloud;
}

}  // namespace

const std::vector<std::string>& cloud_names() {
  static const std::vector<std::string> kNames = {"spheres", "discs", "hair", "grains"};
  return kNames;
}

ShapeCloud make_cloud(const std::string& name, uint32_t count) {
  if (name == "spheres") return scan_torus(CloudKind::kSpheres, count);
  if (name == "discs") return scan_torus(CloudKind::kDiscs, count);
  if (name == "hair") return grow_hair(count);
  if (name == "grains") return fill_box(count);
  throw std::invalid_argument("'" + name + "' is no scene of shapes");
}

}  // namespace kiwami::tools
