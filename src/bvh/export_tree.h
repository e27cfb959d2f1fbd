// SPDX-License-Identifier: Apache-2.0
// Flat trees in the layouts of other tracers.
#pragma once

#include <span>

#include "core/memory.h"
#include "kiwami/export.h"

namespace kiwami {

/// What one of KIWAMI_EXPORT_* asks of a tree, and what it makes of it.
struct ExportFormat {
  uint32_t width;           ///< the most children of a node
  uint32_t most_leaf_size;  ///< the most primitives of a leaf
  size_t node_size;         ///< bytes
  bool has_leaf_nodes;      ///< leaves are nodes of their own
};

/// Throws Error(INVALID_ARGUMENT) for an unknown format.
const ExportFormat& export_format(uint32_t format);

/// Throws Error(INVALID_ARGUMENT) where the tree does not fit into the format.
size_t exported_node_count(std::span<const kiwami_bvh_node> nodes, uint32_t format);

struct ExportedTree {
  Array<unsigned char> nodes;
  Array<uint32_t> positions;  ///< by exported primitive: its place among the tree's primitives
};

/// Throws as exported_node_count does.
ExportedTree export_tree(std::span<const kiwami_bvh_node> nodes, uint32_t format, Memory& memory);

/// The compressed format alone; see kiwami_compressed8_node.
ExportedTree export_compressed(std::span<const kiwami_bvh_node> nodes, Memory& memory);

}  // namespace kiwami
