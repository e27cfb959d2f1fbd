// SPDX-License-Identifier: Apache-2.0
// Boxes of flat trees: made anew, and checked.
#pragma once

#include <span>

#include "core/memory.h"
#include "kiwami/bvh.h"
#include "math/bounds.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Gives each node the union of the boxes below it, level by level from the deepest. boxes are by
/// primitive id.
void refit(Array<kiwami_bvh_node>& nodes, const Array<uint32_t>& primitive_ids,
           const Array<Bounds>& boxes, const Parallel& parallel);

/// Checks every invariant of a flat tree: children side by side after their parents, breadth first,
/// each with its parent and depth; runs of primitives; counts within width and leaf_width; boxes
/// within their parents' and around those of their primitives (in a leaf that has only a part of a
/// primitive, touching it); each primitive with a box that is not empty in some leaf. Throws
/// Error(VALIDATION) that names the node.
void verify_flat_tree(std::span<const kiwami_bvh_node> nodes, const Array<uint32_t>& primitive_ids,
                      const Array<Bounds>& boxes, uint32_t width, uint32_t leaf_width,
                      Memory& memory);

}  // namespace kiwami
