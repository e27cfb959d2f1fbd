// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kiwami/trace.h"
#include "support/mesh.h"
#include "support/random.h"

namespace kiwami_tests {

/// origin + t direction for all t >= 0, with all masks and no flags.
kiwami_ray ray_from(Point origin, Point direction);

/// Rays for any scene: random, at vertices, at points of edges, along edges, along axes with both
/// zeros, from vertices and from the faces of the bounding box, with very short and long
/// directions, odd intervals, masks, culling; a few that are no rays at all (NaN, infinite, zero).
class RayGenerator {
 public:
  /// The scene must outlive the generator.
  RayGenerator(const Scene& scene, Random random);

  kiwami_ray next();

 private:
  Point some_vertex();
  Point edge_point(Point& along);
  Point face_point();
  Point random_point();
  Point origin();
  Point direction_from(Point& origin);
  void vary_length(kiwami_ray& ray);
  void vary_interval(kiwami_ray& ray);
  void spoil(kiwami_ray& ray);

  const Scene& scene_;
  Random random_;
  Point lower_{-1, -1, -1}, upper_{1, 1, 1};
};

/// The same ray with an interval that begins, ends or is just at t, or leaves it out by one unit in
/// the last place.
kiwami_ray with_interval_at(kiwami_ray ray, float t, Random& random);

}  // namespace kiwami_tests
