// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

struct IdRange {
  uint64_t first;
  uint64_t count;
};

/// Whether an id lies in one of some ranges, which rise and do not overlap.
bool contains(std::span<const IdRange> ranges, uint64_t id);

struct ReferenceLimits {
  std::span<const IdRange> ids;  ///< what ids lie in, rising
  float greatest_coordinate;     ///< of boxes and vertices
  /// Receives the slots that each node, then the lanes that each leaf block has in use; nullptr:
  /// nobody asks.
  uint16_t* owned = nullptr;
};

/// Checks, of a tree whose contents nobody vouches for, what the kernels and all walks over trees
/// rely on: each reference leads to a whole node or leaf block of the tree and owns slots (lanes)
/// that nothing else owns, so that there are no cycles and each path is walked once; the depth that
/// the traversal stack bounds; finite boxes within the frame; finite vertices; ids in range; the
/// totals. Sizes are those of the memory already. The tree that it leaves can be traced and
/// looked at safely; whether its boxes are right, verify_wide_tree tells. Takes time linear in the
/// tree, and two bytes a node and leaf block. Throws Error(INVALID_FILE) that names the node.
void check_references(const WideTree& tree, const ReferenceLimits& limits, Memory& memory,
                      const Parallel& parallel);

}  // namespace kiwami
