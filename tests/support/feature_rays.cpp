// SPDX-License-Identifier: Apache-2.0
#include "support/feature_rays.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "support/directions.h"
#include "support/ray_generator.h"

namespace kiwami_tests {

FeatureRayGenerator::FeatureRayGenerator(const ClosedMesh& closed, Random random)
    : closed_(closed), random_(random) {
  Point lower = closed.mesh.vertices.front(), upper = lower;
  for (const Point& p : closed.mesh.vertices) {
    for (int axis = 0; axis < 3; ++axis) {
      lower[axis] = std::min(lower[axis], p[axis]);
      upper[axis] = std::max(upper[axis], p[axis]);
    }
  }
  centre_ = (lower + upper) * 0.5f;
  half_extent_ = (upper - lower) * 0.5f;
}

Point FeatureRayGenerator::feature() {
  const Mesh& mesh = closed_.mesh;
  const auto corner = mesh.corners(random_.below(static_cast<uint32_t>(mesh.triangles.size())));
  const uint32_t k = random_.below(3);
  switch (random_.below(4)) {
    case 0:
      return corner[k];
    case 1:
      return (corner[k] + corner[(k + 1) % 3]) * 0.5f;
    case 2:
      return between(corner[k], corner[(k + 1) % 3], random_);
    default:
      return between(between(corner[0], corner[1], random_), corner[2], random_);
  }
}

Point FeatureRayGenerator::outside_point() {
  if (!closed_.outside.empty() && random_.one_in(3)) {
    return closed_.outside[random_.below(static_cast<uint32_t>(closed_.outside.size()))];
  }
  Point direction;
  float length;
  do {
    direction = random_direction(random_);
    length = std::sqrt(direction.x * direction.x + direction.y * direction.y +
                       direction.z * direction.z);
  } while (!(length > 0.1f && length <= 1.0f));
  // In units of the box's half extents: beyond sqrt(3), some coordinate is outside the box.
  direction = direction * ((1.8f + 2.0f * random_.unit()) / length);
  for (int axis = 0; axis < 3; ++axis) direction[axis] *= half_extent_[axis];
  return centre_ + direction;
}

kiwami_ray FeatureRayGenerator::outside_segment() {
  const Point from = outside_point();
  const bool is_between_known_points = random_.one_in(8);
  const Point at = is_between_known_points ? outside_point() : feature();
  kiwami_ray ray = ray_from(from, at - from);
  // Either end outside, or behind the whole mesh.
  if (is_between_known_points) ray.tmax = 1.0f;
  return ray;
}

kiwami_ray FeatureRayGenerator::line() {
  const Mesh& mesh = closed_.mesh;
  const auto corner = mesh.corners(random_.below(static_cast<uint32_t>(mesh.triangles.size())));
  const Point along = corner[1] - corner[0];
  Point from, direction;
  switch (random_.below(4)) {
    case 0:
      from = feature();
      direction = axis_direction(random_);
      break;
    case 1: {
      direction = along;
      const Point start = corner[random_.below(3)];
      from = start - along * static_cast<float>(random_.between(0, 8));
      break;
    }
    case 2:
      from = outside_point();
      direction = feature() - from;
      break;
    default:
      from = feature();
      direction = odd_direction(random_);
  }
  if (is_zero(direction)) direction = axis_direction(random_);
  kiwami_ray ray = ray_from(from, direction);
  ray.tmin = -std::numeric_limits<float>::infinity();
  return ray;
}

kiwami_ray FeatureRayGenerator::inside_ray() {
  const Point from = closed_.inside[random_.below(static_cast<uint32_t>(closed_.inside.size()))];
  Point direction = random_.one_in(8) ? axis_direction(random_) : feature() - from;
  if (random_.one_in(8)) direction = odd_direction(random_);
  if (is_zero(direction)) direction = axis_direction(random_);
  return ray_from(from, direction);
}

}  // namespace kiwami_tests
