// SPDX-License-Identifier: Apache-2.0
// Scenes that show scenes: random ones, and what they come to in the world.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "support/library.h"
#include "support/mesh.h"
#include "support/random.h"

namespace kiwami_tests {

using Matrix34 = std::array<float, 12>;  ///< three rows of four

/// An array of instances.
struct InstanceArray {
  std::vector<uint32_t> shown;  ///< numbers of earlier scenes, one an instance
  std::vector<Matrix34> transforms;
  std::vector<uint32_t> masks;
  uint32_t mask = ~0u;
};

/// A scene: its meshes first, then its arrays.
struct GraphScene {
  std::vector<Mesh> meshes;
  std::vector<InstanceArray> arrays;
};

/// The last scene is traced; each shows only earlier ones.
struct SceneGraph {
  std::vector<GraphScene> scenes;

  uint32_t depth() const;  ///< instances on the longest path
};

/// A triangle in the world, in double precision, and how a hit names it.
struct WorldTriangle {
  std::array<std::array<double, 3>, 3> corner;
  std::vector<uint32_t> path;  ///< numbers of instances, the outermost first
  uint32_t geometry_id, primitive_id;
  uint32_t mask;
  double condition;  ///< of the matrix that moved it
};

/// A graph with paths of `depth` instances (and shorter ones), with mirrors, non-uniform scales and
/// shears, and at most so many triangles in the world.
SceneGraph random_scene_graph(Random& random, uint32_t depth, size_t max_triangles);

std::vector<WorldTriangle> flatten(const SceneGraph& graph);

/// Builds all scenes; the last one is the traced one. width 0: the device's default.
std::vector<SceneHandle> build(kiwami_device* device, const SceneGraph& graph, uint32_t width,
                               uint32_t rebraid = KIWAMI_REBRAID_OFF);

}  // namespace kiwami_tests
