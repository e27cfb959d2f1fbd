// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// Checks, of a tree whose contents nobody vouches for, what the kernels and all walks over trees
/// rely on: each reference leads to a whole node or leaf block of the tree and owns slots (lanes)
/// that nothing else owns, so that there are no cycles and each path is walked once; the depth that
/// the traversal stack bounds; finite boxes within the frame; finite vertices; ids below id_count;
/// the totals. Sizes are those of the memory already. The tree that it leaves can be traced and
/// looked at safely; whether its boxes are right, verify_wide_tree tells. Takes time linear in the
/// tree, and two bytes a node and leaf block. Throws Error(INVALID_FILE) that names the node.
void check_references(const WideTree& tree, uint64_t id_count, Memory& memory,
                      const Parallel& parallel);

}  // namespace kiwami
