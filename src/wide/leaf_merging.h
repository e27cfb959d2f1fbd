// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"

namespace kiwami {

/// Where the slots (lanes) of one owner stand: mask >> first is a run of ones.
struct SharedPlace {
  uint32_t index;  ///< of the node (leaf block)
  uint16_t mask;
  uint16_t first;
};

/// Places of all owners, and the nodes (leaf blocks) that they need.
struct SharedPlaces {
  Array<SharedPlace> places;
  Array<uint16_t> used;  ///< by node (leaf block): the slots (lanes) that have an owner

  uint32_t count() const { return static_cast<uint32_t>(used.size()); }
};

/// Each owner in a node (leaf block) of its own.
SharedPlaces place_alone(const Array<uint8_t>& sizes, Memory& memory);

/// Leaf-node merging: S. Ogaki, "Fragmentation-Aware Bounding Volume Hierarchies", technical
/// report, 2016. Owners with fewer than width slots share nodes; a ring of ring_size nodes stays
/// open for those that follow, so that partners are close in memory. Departs from it in what to do
/// when no open node fits exactly: a new node is opened while the ring has room, since more open
/// nodes make an exact fit likelier, and two open nodes that together fill one are joined; then
/// the tightest fit is taken that leaves room for another owner (the smallest size); and where
/// there is none, the fullest node is given up: it may only be completed by who fills it exactly,
/// at whatever distance. Serves the lanes of leaf blocks in the same way.
/// Nodes are numbered by their last owner: whoever owns a whole node before it has a lower number.
SharedPlaces place_shared(const Array<uint8_t>& sizes, uint32_t width, uint32_t ring_size,
                          Memory& memory);

}  // namespace kiwami
