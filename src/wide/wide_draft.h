// SPDX-License-Identifier: Apache-2.0
// A wide tree before it is packed: what contractions and direct builders both make.
#pragma once

#include "wide/contraction.h"

namespace kiwami {

/// Slot 0 is the root, which may be a leaf; it stands in no node.
struct WideDraft {
  Array<ContractedNode> nodes;
  Array<uint32_t> children;       ///< by slot: an index into nodes, or kLeafFlag and a leaf
  Array<Bounds> boxes;            ///< by slot
  Array<uint8_t> leaf_sizes;      ///< primitives, by leaf
  Array<uint32_t> primitive_ids;  ///< leaf by leaf
  uint32_t depth = 0;             ///< nodes on the longest path from the root
  double node_area = 0.0;         ///< sum of the half areas of the nodes
  double leaf_area = 0.0;         ///< sum of the half areas of the leaves
  bool has_duplicates = false;    ///< a primitive may stand in several leaves
};

}  // namespace kiwami
