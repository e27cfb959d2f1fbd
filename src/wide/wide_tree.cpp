// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_tree.h"

#include <algorithm>
#include <cfloat>
#include <cstring>
#include <limits>
#include <type_traits>

#include "core/error.h"
#include "math/rounding.h"
#include "wide/contraction.h"
#include "wide/leaf_merging.h"
#include "wide/optimal_contraction.h"
#include "wide/visit_weights.h"

namespace kiwami {
namespace {

/// Nodes (leaf blocks) that one task packs.
constexpr size_t kPackingBlock = 1024;

/// Triangles that are packed while a cache line is under way.
constexpr size_t kLookahead = 12;

/// Bytes that one task copies.
constexpr size_t kCopyingBlock = size_t{1} << 18;

/// Where the owners of a draft go.
struct Layout {
  SharedPlaces nodes;               ///< of the nodes
  SharedPlaces leaves;              ///< of the leaves
  Array<uint32_t> first_primitive;  ///< by leaf, among the draft's primitive_ids
};

Array<uint32_t> first_primitives(const Array<uint8_t>& leaf_sizes, Memory& memory) {
  Array<uint32_t> first(memory, leaf_sizes.size());
  uint32_t next = 0;
  for (size_t leaf = 0; leaf < leaf_sizes.size(); ++leaf) {
    first[leaf] = next;
    next += leaf_sizes[leaf];
  }
  return first;
}

/// What remains of a binary tree when it is contracted.
WideDraft make_draft(const BinaryBvh& binary, Contraction contraction, Memory& memory,
                     const Parallel& parallel) {
  const Array<ContractedSlot> slots = std::move(contraction.slots);
  WideDraft draft{std::move(contraction.nodes),
                  Array<uint32_t>(memory, slots.size()),
                  Array<Bounds>(memory, slots.size()),
                  std::move(contraction.leaf_sizes),
                  {},
                  contraction.depth,
                  contraction.node_area,
                  contraction.leaf_area,
                  binary.has_duplicates};
  const Array<uint32_t> first_primitive = first_primitives(draft.leaf_sizes, memory);
  // Of a primitive that stands in a leaf twice, one is left out: so they may be fewer than before.
  const size_t last = draft.leaf_sizes.size() - 1;
  draft.primitive_ids = Array<uint32_t>(memory, first_primitive[last] + draft.leaf_sizes[last]);
  parallel.for_blocks(slots.size(), kPackingBlock, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      draft.children[i] = slots[i].child;
      draft.boxes[i] = binary.nodes[slots[i].binary_node].bounds;
      if (!slots[i].is_leaf()) continue;
      uint32_t* to = draft.primitive_ids.data() + first_primitive[slots[i].child & ~kLeafFlag];
      copy_ids_below(binary, slots[i].binary_node, to);
    }
  });
  return draft;
}

/// Ray specialized contraction: Y. Gu, Y. He, G. Blelloch, "Ray Specialized Contraction on Bounding
/// Volume Hierarchies", CGF 34(7), 2015. Departs from it in that nodes are not contracted one by
/// one: the visits of the rays take the place of the areas in the contraction of least cost.
Array<float> weigh_by_rays(const BinaryBvh& binary, const TriangleSource& source,
                           const WideTreeConfig& config, Memory& memory, const Parallel& parallel) {
  if (config.contraction != ContractionMethod::kRayDistribution) return {};
  // Rays that can meet no triangle would say that the whole of each line is visited.
  const auto rays = source.mesh_count != 0 ? config.rays : std::span<const RepresentativeRay>();
  return measure_visit_weights(binary, source, rays, kVisitGuessWeight, memory, parallel);
}

SharedPlaces place(const Array<uint8_t>& sizes, const WideTreeConfig& config, Memory& memory) {
  return config.merge_leaves ? place_shared(sizes, config.width, config.merge_ring, memory)
                             : place_alone(sizes, memory);
}

/// Nodes and leaves are placed at the same time: each is a chain of decisions.
Layout make_layout(const WideDraft& draft, const WideTreeConfig& config, Memory& memory,
                   const Parallel& parallel) {
  Layout layout;
  parallel.check_cancelled();
  parallel.for_each(2, [&](size_t part) {
    if (part == 1) {
      layout.leaves = place(draft.leaf_sizes, config, memory);
      layout.first_primitive = first_primitives(draft.leaf_sizes, memory);
      return;
    }
    Array<uint8_t> node_sizes(memory, draft.nodes.size());
    for (size_t i = 0; i < draft.nodes.size(); ++i) {
      node_sizes[i] = static_cast<uint8_t>(draft.nodes[i].slot_count);
    }
    layout.nodes = place(node_sizes, config, memory);
  });
  return layout;
}

/// What a slot refers to once all have their places.
ChildReference reference_of(uint32_t child, const Layout& layout, const WideTree& tree) {
  const bool is_leaf = (child & kLeafFlag) != 0;
  const uint32_t number = child & ~kLeafFlag;
  const SharedPlace& place = is_leaf ? layout.leaves.places[number] : layout.nodes.places[number];
  return is_leaf ? tree.leaf_reference(place.index, place.mask)
                 : tree.node_reference(place.index, place.mask);
}

/// Writes the nodes and leaf blocks of a tree. Block is its LeafBlock or IndexBlock.
template <int N, typename Block>
class Packer {
 public:
  Packer(const WideDraft& draft, const TriangleSource& source, const Layout& layout, WideTree& tree)
      : draft_(draft),
        source_(source),
        layout_(layout),
        tree_(tree),
        nodes_(tree.nodes<N>()),
        leaves_(tree.blocks<Block>()) {}

  void run(const Parallel& parallel) {
    clear(layout_.nodes.used, nodes_, unused_node(), parallel);
    clear(layout_.leaves.used, leaves_, unused_leaf(), parallel);
    // Owners of one node write different slots, so they need no order.
    const Array<ContractedNode>& owners = draft_.nodes;
    parallel.for_blocks(owners.size(), kPackingBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) pack_node(owners[i], layout_.nodes.places[i]);
    });
    const Array<uint8_t>& sizes = draft_.leaf_sizes;
    parallel.for_blocks(sizes.size(), kPackingBlock, [&](size_t begin, size_t end) {
      for (size_t leaf = begin; leaf < end; ++leaf) pack_leaf(static_cast<uint32_t>(leaf));
    });
  }

 private:
  /// Clears those that are not written as a whole later.
  template <typename T>
  static void clear(const Array<uint16_t>& used, T* elements, const T& unused,
                    const Parallel& parallel) {
    constexpr uint16_t kAll = (1u << N) - 1;
    parallel.for_blocks(used.size(), kPackingBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) {
        if (used[i] != kAll) elements[i] = unused;
      }
    });
  }

  static WideNode<N> unused_node() {
    WideNode<N> node{};
    for (int axis = 0; axis < 3; ++axis) {
      std::fill_n(node.bounds[axis][0], N, FLT_MAX);
      std::fill_n(node.bounds[axis][1], N, -FLT_MAX);
    }
    return node;
  }

  static constexpr bool kHasPositions = std::is_same_v<Block, LeafBlock<N>>;

  static Block unused_leaf() {
    Block leaf;
    if constexpr (kHasPositions) {
      std::fill_n(&leaf.position[0][0][0], 9 * N, std::numeric_limits<float>::quiet_NaN());
    }
    std::fill_n(leaf.id, N, KIWAMI_INVALID_ID);
    return leaf;
  }

  void pack_node(const ContractedNode& owner, const SharedPlace& place) {
    WideNode<N>& node = nodes_[place.index];
    for (uint32_t i = 0; i < owner.slot_count; ++i) {
      const uint32_t slot = owner.first_slot + i;
      const uint32_t target = place.first + i;
      const Bounds& box = draft_.boxes[slot];
      for (int axis = 0; axis < 3; ++axis) {
        const float centre = tree_.view.centre[axis];
        node.bounds[axis][0][target] = subtract_down(box.lower[axis], centre);
        node.bounds[axis][1][target] = subtract_up(box.upper[axis], centre);
      }
      node.child[target] = reference_of(draft_.children[slot], layout_, tree_);
    }
  }

  void pack_leaf(uint32_t leaf) {
    const SharedPlace& place = layout_.leaves.places[leaf];
    const uint32_t first = layout_.first_primitive[leaf];
    for (uint32_t i = 0; i < draft_.leaf_sizes[leaf]; ++i) {
      if constexpr (kHasPositions) prefetch_for(first + i);
      pack_primitive(draft_.primitive_ids[first + i], leaves_[place.index], place.first + i);
    }
  }

  /// Triangles that are near each other in the tree lie anywhere in their mesh: what those that
  /// follow need comes into the caches in the meantime, first the indices, then the vertices.
  void prefetch_for(size_t place) const {
    const Array<uint32_t>& ids = draft_.primitive_ids;
    if (place + 2 * kLookahead < ids.size()) source_.prefetch_indices(ids[place + 2 * kLookahead]);
    if (place + kLookahead < ids.size()) source_.prefetch_vertices(ids[place + kLookahead]);
  }

  void pack_primitive(uint32_t id, Block& block, uint32_t lane) {
    block.id[lane] = id;
    if constexpr (kHasPositions) {
      Vec3f corner[3];
      source_.corners_of(id, corner);
      for (int vertex = 0; vertex < 3; ++vertex) {
        for (int axis = 0; axis < 3; ++axis) {
          block.position[vertex][axis][lane] = corner[vertex][axis];
        }
      }
    }
  }

  const WideDraft& draft_;
  const TriangleSource& source_;
  const Layout& layout_;
  const WideTree& tree_;
  WideNode<N>* nodes_;
  Block* leaves_;
};

template <int N>
void pack(const WideDraft& draft, const TriangleSource& source, const Layout& layout,
          WideTree& tree, Memory& memory, const Parallel& parallel) {
  tree.memory = Array<unsigned char>(memory, tree.node_bytes() + tree.leaf_bytes());
  if (tree.leaf_layout == LeafLayout::kTriangles) {
    Packer<N, LeafBlock<N>>(draft, source, layout, tree).run(parallel);
  } else {
    Packer<N, IndexBlock<N>>(draft, source, layout, tree).run(parallel);
  }
}

void check_width(uint32_t width) {
  if (width == 4 || width == 8 || width == 16) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "width is %u, expected 4, 8 or 16", width);
}

}  // namespace

Contraction contract_by(const BinaryBvh& binary, const TriangleSource& source,
                        const WideTreeConfig& config, Memory& memory, const Parallel& parallel) {
  if (config.contraction == ContractionMethod::kSurfaceArea) {
    return contract(binary, config.width, memory, parallel);
  }
  const Array<float> weights = weigh_by_rays(binary, source, config, memory, parallel);
  const OptimalContractionConfig optimal = {
      config.width,        std::min(config.max_leaf_size, config.width),
      config.node_cost,    config.leaf_cost,
      config.merge_leaves, {weights.data(), weights.size()}};
  return contract_optimally(binary, optimal, memory, parallel);
}

WideTree copy_of(const WideTree& tree, Memory& memory, const Parallel& parallel) {
  WideTree copy;
  copy.width = tree.width;
  copy.leaf_width = tree.leaf_width;
  copy.leaf_layout = tree.leaf_layout;
  copy.memory = Array<unsigned char>(memory, tree.memory.size());
  parallel.for_blocks(tree.memory.size(), kCopyingBlock, [&](size_t begin, size_t end) {
    std::memcpy(copy.memory.data() + begin, tree.memory.data() + begin, end - begin);
  });
  copy.view = tree.view;
  copy.view.memory = copy.memory.data();
  copy.node_count = tree.node_count;
  copy.leaf_block_count = tree.leaf_block_count;
  copy.used_slots = tree.used_slots;
  copy.used_lanes = tree.used_lanes;
  copy.depth = tree.depth;
  copy.sah_cost = tree.sah_cost;
  return copy;
}

Vec3f reach_of(const Bounds& box, const Vec3f& centre) {
  Vec3f reach;
  for (int axis = 0; axis < 3; ++axis) {
    reach[axis] = std::max(-subtract_down(box.lower[axis], centre[axis]),
                           subtract_up(box.upper[axis], centre[axis]));
  }
  return reach;
}

void set_frame(const Bounds& root_box, TreeView& view) {
  for (int axis = 0; axis < 3; ++axis) {
    view.centre[axis] = 0.5f * root_box.lower[axis] + 0.5f * root_box.upper[axis];
  }
  view.greatest_bound = reach_of(root_box, view.centre);
}

double relative_cost(const TreeAreas& areas, const Bounds& root_box, double node_cost,
                     double leaf_cost) {
  const double root_area = root_box.half_area();
  // Points and lines have no area: there, each node is as likely to be met as the root.
  if (!(root_area > 0.0)) {
    return node_cost * static_cast<double>(areas.node_count) +
           leaf_cost * static_cast<double>(areas.leaf_count);
  }
  return (node_cost * areas.node_area + leaf_cost * areas.leaf_area) / root_area;
}

WideTree pack_wide_tree(const WideDraft& draft, const TriangleSource& source,
                        const WideTreeConfig& config, Memory& memory, const Parallel& parallel) {
  WideTree tree;
  tree.width = tree.leaf_width = config.width;
  tree.leaf_layout = tree.view.leaf_layout = config.leaf_layout;
  if (draft.primitive_ids.empty()) {
    tree.memory = Array<unsigned char>(memory, 0);
    return tree;
  }
  const Layout layout = make_layout(draft, config, memory, parallel);
  tree.node_count = layout.nodes.count();
  tree.leaf_block_count = layout.leaves.count();
  set_frame(draft.boxes[0], tree.view);
  tree.view.root = reference_of(draft.children[0], layout, tree);
  tree.view.has_duplicates = draft.has_duplicates ? 1 : 0;
  tree.used_slots = draft.children.size() - 1;
  tree.used_lanes = draft.primitive_ids.size();
  tree.depth = draft.depth;
  tree.sah_cost =
      relative_cost({draft.node_area, draft.leaf_area, draft.nodes.size(), draft.leaf_sizes.size()},
                    draft.boxes[0], config.node_cost, config.leaf_cost);
  switch (config.width) {
    case 4:
      pack<4>(draft, source, layout, tree, memory, parallel);
      break;
    case 8:
      pack<8>(draft, source, layout, tree, memory, parallel);
      break;
    default:
      pack<16>(draft, source, layout, tree, memory, parallel);
      break;
  }
  tree.view.memory = tree.memory.data();
  tree.view.memory_bytes = tree.memory.size();
  return tree;
}

WideDraft contract_to_draft(BinaryBvh binary, const TriangleSource& source,
                            const WideTreeConfig& config, Memory& memory,
                            const Parallel& parallel) {
  check_width(config.width);
  if (binary.primitive_ids.empty()) return {};
  Contraction contraction = contract_by(binary, source, config, memory, parallel);
  for (const uint8_t size : contraction.leaf_sizes) {
    if (size <= config.width) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "a leaf owns %u primitives, expected at most %u",
                size, config.width);
  }
  return make_draft(binary, std::move(contraction), memory, parallel);
}

WideTree build_wide_tree(BinaryBvh binary, const TriangleSource& source,
                         const WideTreeConfig& config, Memory& memory, const Parallel& parallel) {
  const WideDraft draft = contract_to_draft(std::move(binary), source, config, memory, parallel);
  return pack_wide_tree(draft, source, config, memory, parallel);
}

}  // namespace kiwami
