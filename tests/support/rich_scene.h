// SPDX-License-Identifier: Apache-2.0
// Small scenes that hold what files can hold, each kind on demand.
#pragma once

#include <kiwami/kiwami.h>

namespace kiwami_tests {

enum : uint32_t {
  /// Arrays of instances with masks of two scenes, one of which shows the other: a shared child.
  kRichInstances = 1u << 0,
  /// Spheres, discs, curves with and without indices.
  kRichShapes = 1u << 1,
  kRichMotion = 1u << 2,
  /// Opacity micromaps with and without indices.
  kRichMicromaps = 1u << 3,
  /// A tree for each mesh.
  kRichTwoLevel = 1u << 4,
  /// Instances that start in the midst of trees.
  kRichRebraided = 1u << 5,
  /// Geometries that the commit did not see, and one that the next will not.
  kRichDisabled = 1u << 6,
  /// Arrays of instances that move, by matrices with masks and by quaternions.
  kRichMovingInstances = 1u << 7,
  kRichAll = (1u << 8) - 1
};

struct RichScene {
  uint32_t parts;  ///< kRich* bits; triangle meshes with masks are always there
  uint32_t width;  ///< children a node
  uint32_t size;   ///< triangles of a mesh; other geometries have about as many primitives
};

/// Makes and commits it. Everything lies in the cube from -1.2 to 1.2, at times 0 to 1. On an error
/// nothing is left. *scene receives the handle, or NULL.
kiwami_result make_rich_scene(kiwami_device* device, const RichScene& what, kiwami_scene** scene);

}  // namespace kiwami_tests
