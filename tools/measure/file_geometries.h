// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <array>
#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Make geometries of what a file holds, at rest or moving. A mesh at rest shares the file's
/// buffers. Throw LibraryError.
kiwami_geometry* make_geometry(kiwami_device* device, const Mesh& mesh);
/// One array of all instances, over a scene of each mesh.
kiwami_geometry* make_instances(kiwami_device* device, const SceneFile& file,
                                const std::vector<kiwami_scene*>& scenes);

/// Puts a leaf in place of each triangle of a mesh at rest.
void set_leaf_mask(kiwami_device* device, kiwami_geometry* geometry, const Mesh& mesh,
                   uint32_t level);

/// The hit on an instance as of the flattened file. Normals go by the cofactors of its matrix: (M b)
/// x (M c) = cof(M) (b x c).
void move_to_world(const std::array<float, 12>& m, kiwami_hit& hit);

}  // namespace kiwami::tools
