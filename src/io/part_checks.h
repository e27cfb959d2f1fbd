// SPDX-License-Identifier: Apache-2.0
// What kernels rely on in the parts of a scene beside their trees, of files that nobody vouches
// for.
#pragma once

#include <span>

#include "core/memory.h"
#include "core/saved_scene.h"
#include "io/tree_sections.h"
#include "parallel/parallel.h"

namespace kiwami::file {

/// Checks that every instance is of one of the shown scenes (their numbers in the file) and can be
/// entered, and that re-braided ones start at references of their trees, which have been checked.
/// Throws Error(INVALID_FILE).
void check_instances(const SavedInstances& instances, std::span<const uint32_t> shown,
                     const SavedForest& forest, const Parallel& parallel);

/// Checks that boxes of moving triangles are finite. Throws Error(INVALID_FILE).
void check_motion_bounds(std::span<const float> bounds, const Parallel& parallel);

}  // namespace kiwami::file
