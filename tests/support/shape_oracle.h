// SPDX-License-Identifier: Apache-2.0
// What the library must answer of spheres, discs and curve segments: the formulas of its
// documentation in a plain loop. It shares no code with the library: only the public structs.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "kiwami/trace.h"
#include "support/mesh.h"
#include "support/random.h"

namespace kiwami_tests {

enum class ShapeType { kSpheres, kDiscs, kCurves };

/// One geometry of shapes.
struct ShapeSet {
  ShapeType type = ShapeType::kSpheres;
  std::vector<std::array<float, 4>> points;
  std::vector<Point> normals;     ///< of discs
  std::vector<uint32_t> indices;  ///< of curves: first points
  uint32_t mask = ~0u;

  size_t count() const { return type == ShapeType::kCurves ? indices.size() : points.size(); }
};

/// Random shapes of a type about the cube from -1 to 1 times scale: apart, nested, in one place,
/// thin and thick, some of them nothing at all. Sets by number have each another character.
ShapeSet random_shapes(ShapeType type, uint32_t number, uint32_t count, Random& random);

/// The points of a set and some of its surface as a scene, for what aims rays.
Scene targets_of(const std::vector<ShapeSet>& sets);

/// All hits of a ray with sets, set i being geometry first_geometry_id + i, by (t, geometry,
/// primitive).
std::vector<kiwami_hit> shape_hits(const std::vector<ShapeSet>& sets, uint32_t first_geometry_id,
                                   const kiwami_ray& ray);

}  // namespace kiwami_tests
