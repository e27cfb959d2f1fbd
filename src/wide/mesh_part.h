// SPDX-License-Identifier: Apache-2.0
// What a kernel needs of the meshes of a scene that have a tree each.
#pragma once

#include "wide/wide_bvh.h"

namespace kiwami {

/// The leaves of the part's tree hold indices of scenes. They lie in the space of the outer scene
/// and add nothing to a path. Plain data.
struct MeshPart {
  const SceneView* const* scenes;
};

}  // namespace kiwami
