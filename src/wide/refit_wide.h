// SPDX-License-Identifier: Apache-2.0
// New boxes for a wide tree whose triangles have moved.
#pragma once

#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// What a tree's boxes are once they are made anew.
struct RefitResult {
  Bounds bounds = Bounds::empty();  ///< of the triangles that can be hit
  uint64_t vanished_lanes = 0;      ///< lanes whose triangle can not be hit any more
};

/// Writes the triangles of the source into the tree's leaf blocks (where these hold any) and gives
/// each slot the box around what its owner has below it, from the leaves to the root; the tree
/// keeps its shape. A triangle that can not be hit any more leaves NaN in its lane, and comes back
/// when it can again; a slot of such triangles alone has the box of an unused one. Sets the tree's
/// frame and its cost (by these costs of a node and of a leaf block). A triangle that stands in
/// several leaves has its whole box in each. Throws Error(INVALID_ARGUMENT) for an index at or
/// beyond its mesh's vertex count; then, as after any other exception, the tree's contents are of
/// no use until a refit succeeds.
RefitResult refit_wide_tree(WideTree& tree, const TriangleSource& source, double node_cost,
                            double leaf_cost, Memory& memory, const Parallel& parallel);

}  // namespace kiwami
