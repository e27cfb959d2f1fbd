// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "measure/camera.h"
#include "measure/tracer.h"
#include "scene/random.h"

namespace kiwami::tools {

/// Rays of one kind, with its name.
struct RaySet {
  std::string name;
  std::vector<kiwami_ray> rays;
};

bool is_hit(const kiwami_hit& hit);

/// The hit point, moved off the surface to the side that the ray came from, and the unit normal of
/// that side.
struct Surface {
  Vec3 point;
  Vec3 normal;
};
Surface surface_of(const kiwami_ray& ray, const kiwami_hit& hit);

/// A direction of unit length, distributed evenly, or by the cosine around a unit normal. No
/// function of the mathematical library but sqrt is used: the bits are the same everywhere.
Vec3 uniform_direction(Random& random);
Vec3 cosine_direction(Vec3 normal, Random& random);

/// One ray through the middle of each pixel, row by row.
RaySet primary_rays(const Camera& camera);

/// From each hit of `rays`, one diffuse bounce; from a miss none. Then, while there are fewer than
/// `count`, further ones from the same hits; at last shuffled, so that neighbours have nothing in
/// common. Empty when nothing was hit.
RaySet bounce_rays(const Tracer& tracer, std::span<const kiwami_ray> rays, size_t count,
                   uint64_t seed);

/// From anywhere in the box or a little outside to anywhere; some short, some with flags.
RaySet random_rays(const Box& box, size_t count, uint64_t seed);

/// Parallel to an axis, with zeros of both signs, through random points and through vertices.
RaySet axis_rays(const SceneFile& scene, const Box& box, size_t count, uint64_t seed);

/// Aimed at vertices and at points on edges, from anywhere and from other vertices.
RaySet aimed_rays(const SceneFile& scene, const Box& box, size_t count, uint64_t seed);

}  // namespace kiwami::tools
