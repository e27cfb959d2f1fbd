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
  // Of those that move, instead of transforms.
  uint32_t step_count = 1;  ///< 1: they rest
  uint32_t format = KIWAMI_TRANSFORM_MATRIX;
  float begin = 0.0f, end = 1.0f;
  std::vector<float> steps;  ///< of one instance after the other

  /// Floats of a step.
  size_t step_size() const { return format == KIWAMI_TRANSFORM_MATRIX ? 12 : 16; }
};

/// A scene: its meshes first, then its arrays.
struct GraphScene {
  std::vector<Mesh> meshes;
  std::vector<InstanceArray> arrays;
  /// Of each mesh the vertices at time 1, whose own are those at time 0; empty: it rests.
  std::vector<std::vector<Point>> moved = {};
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

/// The same with moving arrays, by matrices and by quaternions, and moving meshes.
SceneGraph in_motion(SceneGraph graph, Random& random);

/// What a moving graph is at a time: nothing moves, what is not there is hidden. Matrices are
/// interpolated here; those of quaternions are told by the library, of arrays over these scenes,
/// which were built of the graph.
SceneGraph frozen(const SceneGraph& graph, kiwami_device* device,
                  const std::vector<SceneHandle>& scenes, float time);

/// Of a graph in which nothing moves.
std::vector<WorldTriangle> flatten(const SceneGraph& graph);

/// Builds all scenes; the last one is the traced one. width 0: the device's default.
std::vector<SceneHandle> build(kiwami_device* device, const SceneGraph& graph, uint32_t width,
                               uint32_t rebraid = KIWAMI_REBRAID_OFF);

}  // namespace kiwami_tests
