// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "support/mesh.h"

namespace kiwami_tests {

/// A mesh in which each edge belongs to exactly two triangles.
struct ClosedMesh {
  std::string name;
  Mesh mesh;
  std::vector<Point> inside;   ///< well inside
  std::vector<Point> outside;  ///< well outside, near: in a hole or between spikes; maybe none
};

/// How GoogleTest prints one.
inline void PrintTo(const ClosedMesh& closed, std::ostream* stream) { *stream << closed.name; }

/// A sphere, a torus, a box of slivers, a star of thin spikes, a sphere far from the origin, one of
/// 10^7 : 1, and one on integer coordinates, where most rays through features meet them exactly.
std::vector<ClosedMesh> closed_meshes();

/// The mesh alone as a scene.
Scene scene_of(const ClosedMesh& closed);

/// Whether each directed edge meets its opposite exactly once.
bool is_closed(const Mesh& mesh);

}  // namespace kiwami_tests
