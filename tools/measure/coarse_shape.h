// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// What a scene looks like from far: three floats a vertex, three indices a triangle.
struct CoarseShape {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;

  uint64_t triangle_count() const { return indices.size() / 3; }
};

/// The triangles of a scene without instances, or, where they are more than `most_triangles`, those
/// that remain when all vertices of a cell of a grid become one: J. Rossignac, P. Borrel:
/// Multi-resolution 3D approximations for rendering complex scenes, Modeling in Computer Graphics,
/// 1993. The grid is the finest that leaves few enough; a cell's vertex is the first that lies in
/// it, not their weighted mean. Triangles that cannot be hit are left out.
CoarseShape coarse_shape(const SceneFile& scene, uint64_t most_triangles);

}  // namespace kiwami::tools
