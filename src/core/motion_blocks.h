// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/motion_part.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// The mesh of a triangle by its number in the part.
const MovingMeshView& mesh_of(const MotionPart& part, uint32_t id);

/// Whether all meshes have two steps, so that leaves may hold both.
bool may_have_blocks(const MotionPart& part);

/// The corners of the triangles of each leaf block of a tree at both steps: see MotionPart::blocks.
Array<float> make_motion_blocks(const MotionPart& part, const WideTree& tree, Memory& memory,
                                const Parallel& parallel);

}  // namespace kiwami
