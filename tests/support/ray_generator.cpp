// SPDX-License-Identifier: Apache-2.0
#include "support/ray_generator.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "support/directions.h"

namespace kiwami_tests {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

bool is_usable(Point p) {
  return std::fabs(p.x) <= KIWAMI_MAX_COORDINATE && std::fabs(p.y) <= KIWAMI_MAX_COORDINATE &&
         std::fabs(p.z) <= KIWAMI_MAX_COORDINATE;
}

Point scaled_by(Point p, int exponent) {
  return {std::ldexp(p.x, exponent), std::ldexp(p.y, exponent), std::ldexp(p.z, exponent)};
}

}  // namespace

kiwami_ray ray_from(Point origin, Point direction) {
  return {origin.x,    origin.y,  origin.z, 0.0f, direction.x, direction.y,
          direction.z, kInfinity, 0.0f,     ~0u,  0,           0};
}

RayGenerator::RayGenerator(const Scene& scene, Random random) : scene_(scene), random_(random) {
  Point lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  for (const Mesh& mesh : scene.meshes) {
    for (const Point& p : mesh.vertices) {
      if (!is_usable(p)) continue;
      for (int axis = 0; axis < 3; ++axis) {
        lower[axis] = std::min(lower[axis], p[axis]);
        upper[axis] = std::max(upper[axis], p[axis]);
      }
    }
  }
  if (lower.x <= upper.x) {
    lower_ = lower;
    upper_ = upper;
  }
}

Point RayGenerator::random_point() {
  Point p;
  for (int axis = 0; axis < 3; ++axis) {
    p[axis] = lower_[axis] + (upper_[axis] - lower_[axis]) * (random_.unit() * 1.5f - 0.25f);
  }
  return p;
}

Point RayGenerator::some_vertex() {
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Mesh& mesh = scene_.meshes[random_.below(static_cast<uint32_t>(scene_.meshes.size()))];
    if (mesh.vertices.empty()) continue;
    const Point p = mesh.vertices[random_.below(static_cast<uint32_t>(mesh.vertices.size()))];
    if (is_usable(p)) return p;
  }
  return random_point();
}

Point RayGenerator::edge_point(Point& along) {
  for (int attempt = 0; attempt < 4; ++attempt) {
    const Mesh& mesh = scene_.meshes[random_.below(static_cast<uint32_t>(scene_.meshes.size()))];
    if (mesh.triangles.empty()) continue;
    const auto corner = mesh.corners(random_.below(static_cast<uint32_t>(mesh.triangles.size())));
    const uint32_t k = random_.below(3);
    const Point a = corner[k], b = corner[(k + 1) % 3];
    if (!is_usable(a) || !is_usable(b)) continue;
    along = b - a;
    return between(a, b, random_);
  }
  along = random_direction(random_);
  return random_point();
}

Point RayGenerator::face_point() {
  Point unused;
  const Point on_edge = edge_point(unused);
  return between(on_edge, some_vertex(), random_);
}

Point RayGenerator::origin() {
  switch (random_.below(8)) {
    case 0:
      return some_vertex();
    case 1: {
      Point unused;
      return edge_point(unused);
    }
    case 2: {
      // On a face of the bounding box.
      Point p = random_point();
      const int axis = random_.between(0, 2);
      p[axis] = random_.one_in(2) ? lower_[axis] : upper_[axis];
      return p;
    }
    case 3: {
      // In line with a vertex.
      Point p = random_point();
      const Point v = some_vertex();
      p[random_.between(0, 2)] = v[random_.between(0, 2)];
      return p;
    }
    case 4:
      return {random_.one_in(2) ? 0.0f : -0.0f, 0.0f, 0.0f};
    case 5: {
      const Point p = random_point();
      const Point far = p * random_.power_of_two(1, 24);
      return is_usable(far) ? far : p;
    }
    default:
      return random_point();
  }
}

/// May move the origin, so that the line passes a feature exactly.
Point RayGenerator::direction_from(Point& origin) {
  Point along;
  switch (random_.below(10)) {
    case 0:
      return some_vertex() - origin;
    case 1:
      return edge_point(along) - origin;
    case 2:
      return face_point() - origin;
    case 3: {
      const Point p = edge_point(along);
      origin = p - along * random_.power_of_two(-2, 3);
      return along;
    }
    case 4:
      return axis_direction(random_);
    case 5: {
      // Along an axis through a vertex, with the other coordinates exactly its own.
      const Point direction = axis_direction(random_);
      const Point v = random_.one_in(2) ? some_vertex() : edge_point(along);
      for (int axis = 0; axis < 3; ++axis) {
        if (direction[axis] == 0.0f) origin[axis] = v[axis];
      }
      return direction;
    }
    case 6: {
      const Point direction = odd_direction(random_);
      const Point target = some_vertex();
      origin = target - direction * random_.power_of_two(0, 6);
      return direction;
    }
    case 7:
      return odd_direction(random_);
    case 8: {
      const Point from = some_vertex();
      return some_vertex() - from;
    }
    default:
      return random_direction(random_);
  }
}

void RayGenerator::vary_length(kiwami_ray& ray) {
  Point direction{ray.direction_x, ray.direction_y, ray.direction_z};
  const float greatest =
      std::max({std::fabs(direction.x), std::fabs(direction.y), std::fabs(direction.z)});
  // To about 1, or anywhere between 2^-100 and 2^100.
  const int exponent = -std::ilogb(greatest) + (random_.one_in(2) ? 0 : random_.between(-100, 100));
  direction = scaled_by(direction, exponent);
  ray.direction_x = direction.x;
  ray.direction_y = direction.y;
  ray.direction_z = direction.z;
}

void RayGenerator::vary_interval(kiwami_ray& ray) {
  const float reach = std::max({upper_.x - lower_.x, upper_.y - lower_.y, upper_.z - lower_.z});
  switch (random_.below(6)) {
    case 0:
      ray.tmax = random_.unit() * 2.0f;
      break;
    case 1:
      ray.tmin = random_.unit() * reach;
      break;
    case 2:
      ray.tmin = -kInfinity;
      break;
    case 3:
      ray.tmin = -reach * random_.unit();
      break;
    case 4:
      ray.tmin = ray.tmax = random_.unit();
      break;
    default:
      ray.tmax = std::numeric_limits<float>::max();
  }
}

void RayGenerator::spoil(kiwami_ray& ray) {
  const float bad[] = {kNan, kInfinity, -kInfinity, 0x1.000002p60f, -0x1p61f};
  const float value = bad[random_.below(std::size(bad))];
  float* const fields[] = {&ray.origin_x,    &ray.origin_y,    &ray.origin_z, &ray.direction_x,
                           &ray.direction_y, &ray.direction_z, &ray.tmin,     &ray.tmax};
  switch (random_.below(4)) {
    case 0:
      ray.direction_x = ray.direction_y = ray.direction_z = random_.one_in(2) ? 0 : -0.0f;
      break;
    case 1:
      ray.tmin = 1.0f, ray.tmax = 0.5f;
      break;
    default:
      *fields[random_.below(std::size(fields))] = value;
  }
}

kiwami_ray RayGenerator::next() {
  Point from = origin();
  Point direction = direction_from(from);
  if (!is_usable(from)) from = random_point();
  if (!std::isfinite(direction.x + direction.y + direction.z) || is_zero(direction)) {
    direction = random_direction(random_);
  }
  kiwami_ray ray = ray_from(from, direction);
  if (random_.one_in(4) && !is_zero(direction)) vary_length(ray);
  if (random_.one_in(4)) vary_interval(ray);
  if (random_.one_in(6)) ray.flags = random_.below(4);
  if (random_.one_in(6)) ray.mask = random_.below(8);
  if (random_.one_in(64)) spoil(ray);
  return ray;
}

kiwami_ray with_interval_at(kiwami_ray ray, float t, Random& random) {
  switch (random.below(6)) {
    case 0:
      ray.tmin = ray.tmax = t;
      break;
    case 1:
      ray.tmin = t;
      break;
    case 2:
      ray.tmax = t;
      break;
    case 3:
      ray.tmin = std::nextafter(t, kInfinity);
      break;
    case 4:
      ray.tmax = std::nextafter(t, -kInfinity);
      break;
    default:
      ray.tmin = ray.tmax = std::nextafter(t, random.one_in(2) ? kInfinity : -kInfinity);
  }
  return ray;
}

}  // namespace kiwami_tests
