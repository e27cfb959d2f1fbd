// SPDX-License-Identifier: Apache-2.0
#include "measure/ray_sets.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiwami::tools {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();

Vec3 random_point(const Box& box, Random& random) {
  const float x = random.uniform(box.low.x, box.high.x);
  const float y = random.uniform(box.low.y, box.high.y);
  const float z = random.uniform(box.low.z, box.high.z);
  return {x, y, z};
}

Box widened(const Box& box, float fraction) {
  const Vec3 margin = box.extent() * fraction;
  return {box.low - margin, box.high + margin};
}

float largest(Vec3 v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

/// Vertices of random triangles; those that the library skips give rays that hit nothing, which
/// must agree too.
class TrianglePicker {
 public:
  TrianglePicker(const SceneFile& scene, Random& random) : scene_(scene), random_(random) {
    for (size_t i = 0; i < scene.meshes.size(); ++i) {
      if (!scene.meshes[i].indices.empty()) filled_.push_back(i);
    }
  }

  bool empty() const { return filled_.empty(); }

  Vec3 vertex() { return corner(pick(), random_.below(3)); }

  Vec3 edge_point() {
    const Triangle triangle = pick();
    const uint32_t first = random_.below(3);
    const Vec3 a = corner(triangle, first);
    const Vec3 b = corner(triangle, (first + 1) % 3);
    const float t = random_.uniform();
    return a * (1.0f - t) + b * t;
  }

 private:
  struct Triangle {
    const Mesh* mesh;
    size_t first_index;
  };

  Triangle pick() {
    const Mesh& mesh = scene_.meshes[filled_[random_.below(static_cast<uint32_t>(filled_.size()))]];
    return {&mesh, size_t{random_.below(static_cast<uint32_t>(mesh.triangle_count()))} * 3};
  }

  static Vec3 corner(const Triangle& triangle, uint32_t number) {
    const uint32_t index = triangle.mesh->indices[triangle.first_index + number];
    const float* v = &triangle.mesh->vertices[size_t{index} * 3];
    return {v[0], v[1], v[2]};
  }

  const SceneFile& scene_;
  Random& random_;
  std::vector<size_t> filled_;
};

/// Some rays end early, begin late, or cull.
void vary(kiwami_ray& ray, Random& random, float scale) {
  const uint32_t choice = random.below(16);
  if (choice < 3) ray.tmax = scale * random.uniform();
  if (choice == 3 || choice == 4) ray.tmin = scale * 0.5f * random.uniform();
  if (choice == 5) ray.flags = KIWAMI_RAY_CULL_BACK_FACES;
  if (choice == 6) ray.flags = KIWAMI_RAY_CULL_FRONT_FACES;
}

}  // namespace

bool is_hit(const kiwami_hit& hit) { return hit.primitive_id != KIWAMI_INVALID_ID; }

Surface surface_of(const kiwami_ray& ray, const kiwami_hit& hit) {
  const Vec3 origin{ray.origin_x, ray.origin_y, ray.origin_z};
  const Vec3 direction{ray.direction_x, ray.direction_y, ray.direction_z};
  const Vec3d exact{hit.normal_x, hit.normal_y, hit.normal_z};
  const double size = length(exact);
  Vec3 normal = normalize(direction) * -1.0f;
  if (size > 0.0) {
    normal = {static_cast<float>(exact.x / size), static_cast<float>(exact.y / size),
              static_cast<float>(exact.z / size)};
  }
  if (dot(normal, direction) > 0.0f) normal = normal * -1.0f;
  const Vec3 point = origin + direction * hit.t;
  // Above the rounding of the point, which grows with the coordinates that made it.
  const float offset = 1e-5f * (largest(point) + largest(origin) * 0.25f);
  return {point + normal * offset, normal};
}

Vec3 uniform_direction(Random& random) {
  for (;;) {
    const float x = random.uniform(-1.0f, 1.0f);
    const float y = random.uniform(-1.0f, 1.0f);
    const float z = random.uniform(-1.0f, 1.0f);
    const float square = x * x + y * y + z * z;
    if (square > 1e-4f && square <= 1.0f) return Vec3{x, y, z} * (1.0f / std::sqrt(square));
  }
}

Vec3 cosine_direction(Vec3 normal, Random& random) {
  // A point of the unit sphere that touches the surface from above.
  for (;;) {
    const Vec3 direction = normal + uniform_direction(random);
    if (dot(direction, direction) > 1e-6f) return normalize(direction);
  }
}

RaySet primary_rays(const Camera& camera) {
  RaySet set{"primary", {}};
  set.rays.reserve(size_t{camera.width()} * camera.height());
  for (uint32_t y = 0; y < camera.height(); ++y) {
    for (uint32_t x = 0; x < camera.width(); ++x) {
      set.rays.push_back(camera.ray(static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f));
    }
  }
  return set;
}

RaySet bounce_rays(const Tracer& tracer, std::span<const kiwami_ray> rays, size_t count,
                   uint64_t seed) {
  RaySet set{"bounce", {}};
  std::vector<kiwami_hit> hits(rays.size());
  tracer.closest_hits(rays, hits);
  std::vector<Surface> surfaces;
  for (size_t i = 0; i < rays.size(); ++i) {
    if (is_hit(hits[i])) surfaces.push_back(surface_of(rays[i], hits[i]));
  }
  if (surfaces.empty()) return set;
  Random random(seed, 1);
  set.rays.reserve(count);
  for (size_t i = 0; i < count; ++i) {
    const Surface& surface = surfaces[i % surfaces.size()];
    const Vec3 direction = cosine_direction(surface.normal, random);
    set.rays.push_back(make_ray(surface.point, direction, 0.0f, kInfinity));
  }
  for (size_t i = set.rays.size(); i > 1; --i) {
    std::swap(set.rays[i - 1], set.rays[random.below(static_cast<uint32_t>(i))]);
  }
  return set;
}

RaySet random_rays(const Box& box, size_t count, uint64_t seed) {
  RaySet set{"random", {}};
  Random random(seed, 2);
  const Box larger = widened(box, 0.1f);
  for (size_t i = 0; i < count; ++i) {
    kiwami_ray ray =
        make_ray(random_point(larger, random), uniform_direction(random), 0.0f, kInfinity);
    vary(ray, random, box.diagonal());
    set.rays.push_back(ray);
  }
  return set;
}

RaySet axis_rays(const SceneFile& scene, const Box& box, size_t count, uint64_t seed) {
  RaySet set{"axis-parallel", {}};
  Random random(seed, 3);
  TrianglePicker picker(scene, random);
  const float distance = 0.75f * box.diagonal() + 1.0f;
  for (size_t i = 0; i < count; ++i) {
    const bool through_vertex = random.below(2) == 0 && !picker.empty();
    const Vec3 point = through_vertex ? picker.vertex() : random_point(box, random);
    const uint32_t axis = random.below(3);
    const bool backwards = random.below(2) == 0;
    float direction[3];
    for (float& component : direction) component = random.below(2) == 0 ? 0.0f : -0.0f;
    direction[axis] = backwards ? -1.0f : 1.0f;
    float origin[3] = {point.x, point.y, point.z};
    origin[axis] -= direction[axis] * (random.below(4) == 0 ? 0.0f : distance);
    set.rays.push_back(make_ray({origin[0], origin[1], origin[2]},
                                {direction[0], direction[1], direction[2]}, 0.0f, kInfinity));
  }
  return set;
}

RaySet aimed_rays(const SceneFile& scene, const Box& box, size_t count, uint64_t seed) {
  RaySet set{"aimed", {}};
  Random random(seed, 4);
  TrianglePicker picker(scene, random);
  if (picker.empty()) return set;
  const Box larger = widened(box, 0.5f);
  for (size_t i = 0; i < count; ++i) {
    const Vec3 target = random.below(2) == 0 ? picker.vertex() : picker.edge_point();
    const Vec3 origin = random.below(8) == 0 ? picker.vertex() : random_point(larger, random);
    set.rays.push_back(make_ray(origin, target - origin, 0.0f, kInfinity));
  }
  return set;
}

}  // namespace kiwami::tools
