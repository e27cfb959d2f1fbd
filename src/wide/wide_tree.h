// SPDX-License-Identifier: Apache-2.0
// The owner of an N-wide tree, made from a binary one: contraction, leaf-node merging, packing.
#pragma once

#include <span>

#include "bvh/binary_bvh.h"
#include "bvh/representative_rays.h"
#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/contraction.h"
#include "wide/wide_bvh.h"
#include "wide/wide_draft.h"

namespace kiwami {

struct WideTree {
  uint32_t width = 0;       ///< children a node: 4, 8 or 16
  uint32_t leaf_width = 0;  ///< primitives a leaf block; equals width
  LeafLayout leaf_layout = LeafLayout::kTriangles;
  Array<unsigned char> memory;  ///< the nodes, then the leaf blocks: what the view points to
  TreeView view{};
  uint64_t node_count = 0;
  uint64_t leaf_block_count = 0;
  uint64_t used_slots = 0;  ///< node slots that are in some mask
  uint64_t used_lanes = 0;  ///< leaf lanes that are in some mask
  uint32_t depth = 0;       ///< nodes on the longest path from the root to a leaf
  double sah_cost = 0.0;    ///< relative to the root box

  size_t node_bytes() const { return node_count * width * (sizeof(WideNode<4>) / 4); }
  size_t leaf_block_bytes() const { return kiwami::leaf_block_bytes(leaf_layout, leaf_width); }
  size_t leaf_bytes() const { return leaf_block_count * leaf_block_bytes(); }
  template <int N>
  WideNode<N>* nodes() const {
    return reinterpret_cast<WideNode<N>*>(const_cast<unsigned char*>(memory.data()));
  }
  /// Block is the LeafBlock or IndexBlock of the tree's layout and width.
  template <typename Block>
  Block* blocks() const {
    return reinterpret_cast<Block*>(const_cast<unsigned char*>(memory.data()) + node_bytes());
  }
  template <int N>
  LeafBlock<N>* leaves() const {
    return blocks<LeafBlock<N>>();
  }
  /// The ids in a leaf block, by its number, in either layout.
  uint32_t* leaf_ids(uint64_t number) const {
    return reinterpret_cast<uint32_t*>(blocks<unsigned char>() + number * leaf_block_bytes() +
                                       leaf_ids_offset(leaf_layout, leaf_width));
  }
  /// References to a node and to a leaf block by number.
  ChildReference node_reference(uint64_t number, uint32_t mask) const {
    return ChildReference::to_node(number * width * (sizeof(WideNode<4>) / 4), mask);
  }
  ChildReference leaf_reference(uint64_t number, uint32_t mask) const {
    return ChildReference::to_leaf(node_bytes() + number * leaf_block_bytes(), mask);
  }
  /// The number of the node or leaf block that a reference leads to, rounded down.
  uint64_t number_of(ChildReference reference) const {
    return reference.is_leaf() ? (reference.leaf_offset() - node_bytes()) / leaf_block_bytes()
                               : reference.node_offset() / (width * sizeof(WideNode<4>) / 4);
  }
};

/// How the children of a wide node are chosen; the numbers of KIWAMI_PARAMETER_CONTRACTION.
enum class ContractionMethod : uint32_t { kSurfaceArea = 0, kOptimal = 1, kRayDistribution = 2 };

struct WideTreeConfig {
  uint32_t width = 8;
  LeafLayout leaf_layout = LeafLayout::kTriangles;
  ContractionMethod contraction = ContractionMethod::kSurfaceArea;
  uint32_t max_leaf_size = 8;  ///< of leaves that the optimal contraction makes
  bool merge_leaves = true;
  uint32_t merge_ring = 8;
  float node_cost = 1.0f;
  float leaf_cost = 1.0f;
  std::span<const RepresentativeRay> rays = {};  ///< for kRayDistribution
};

/// The contraction that the config names. The source is that of the rays' hits; where it holds no
/// triangles, as for a tree over boxes, rays do not count.
Contraction contract_by(const BinaryBvh& binary, const TriangleSource& source,
                        const WideTreeConfig& config, Memory& memory, const Parallel& parallel);

/// The same tree in memory of its own.
WideTree copy_of(const WideTree& tree, Memory& memory, const Parallel& parallel);

/// The greatest absolute coordinates of a box relative to a centre, rounded up.
Vec3f reach_of(const Bounds& box, const Vec3f& centre);

/// Gives stored boxes a frame around the root's box. Boxes lie within the root's, and rounding
/// keeps that order, so the root has the greatest bounds.
void set_frame(const Bounds& root_box, TreeView& view);

/// What the nodes and leaves of a tree add up to, each for each of its owners.
struct TreeAreas {
  double node_area = 0.0, leaf_area = 0.0;  ///< sums of half areas
  uint64_t node_count = 0, leaf_count = 0;
};

/// The surface area heuristic, relative to the root's box.
double relative_cost(const TreeAreas& areas, const Bounds& root_box, double node_cost,
                     double leaf_cost);

/// Contracts a binary tree whose leaves own at most config.width primitives. Takes the tree, to
/// free it before the wide one is written.
WideDraft contract_to_draft(BinaryBvh binary, const TriangleSource& source,
                            const WideTreeConfig& config, Memory& memory, const Parallel& parallel);

/// contract_to_draft, then pack_wide_tree. A tree over boxes has a source without meshes, and index
/// leaves.
WideTree build_wide_tree(BinaryBvh binary, const TriangleSource& source,
                         const WideTreeConfig& config, Memory& memory, const Parallel& parallel);

/// Merges leaf nodes and leaf blocks as the config says, and writes what the kernels read.
WideTree pack_wide_tree(const WideDraft& draft, const TriangleSource& source,
                        const WideTreeConfig& config, Memory& memory, const Parallel& parallel);

/// Checks every invariant of the tree: references and depth in range; each slot and lane owned by
/// exactly one path; boxes (in the stored frame, rounded outwards) around all below; each of the
/// primitive_count triangles in exactly one lane, with its original vertices where the layout has
/// any; the root's view. In a tree that has_duplicates a triangle may stand in several leaves, in
/// each once: their boxes together cover it.
/// Throws Error(VALIDATION) that names the node.
void verify_wide_tree(const WideTree& tree, const TriangleSource& source, uint64_t primitive_count,
                      Memory& memory);

/// The same of a tree over boxes, which stand by rising id.
void verify_wide_tree(const WideTree& tree, std::span<const BuildPrimitive> boxes, Memory& memory);

}  // namespace kiwami
