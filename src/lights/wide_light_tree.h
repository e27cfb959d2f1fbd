// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_clusters.h"

namespace kiwami {

/// The binary tree over lights contracted to nodes of 2, 4, 8 or 16 slots. The talk that these
/// trees come from (S. Ogaki, CEDEC 2019) gives the reason: a node near the root says little about
/// its lights, so it is better to choose one of eight at once than to choose among two three times.
///
/// Nodes of two children have four slots, two of them empty: so that vector kernels, which have four
/// lanes and more, choose among them, too. Which clusters are the slots of which node is kept, so
/// that nodes can be written anew (refit).
struct WideLightTree {
  uint32_t width = 0;  ///< children of a node
  uint32_t node_count = 0;
  uint32_t depth = 0;
  double cost = 0.0;              ///< power * M_A * M_Omega of all slots, relative to the root's
  Array<uint32_t> slot_clusters;  ///< by slot: the cluster (binary node), or kNoLightSlot
  Array<unsigned char> nodes;     ///< LightNode of slots_of(width)
  Array<uint32_t> leaf_slots;     ///< see LightTreeView
  Array<uint32_t> parent_slots;   ///< by node

  uint64_t bytes() const {
    return slot_clusters.bytes() + nodes.bytes() + leaf_slots.bytes() + parent_slots.bytes();
  }
};

/// The slots of nodes with as many children.
inline uint32_t slots_of(uint32_t width) { return width < 4 ? 4 : width; }

/// Opens, in each node, the inner cluster that costs the most by the surface area orientation
/// heuristic, until the slots are used.
WideLightTree contract(const LightLinks& links, const Array<LightCluster>& clusters, uint32_t width,
                       uint32_t leaf_count, Memory& memory);

/// Writes the nodes of another tree's shape from other clusters.
WideLightTree rewritten(const WideLightTree& shape, const LightLinks& links,
                        const Array<LightCluster>& clusters, uint32_t leaf_count, Memory& memory);

/// What LightTreeView says of the whole.
void describe_root(const LightCluster& root, LightTreeView& view);

}  // namespace kiwami
