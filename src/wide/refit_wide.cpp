// SPDX-License-Identifier: Apache-2.0
#include "wide/refit_wide.h"

#include <algorithm>
#include <bit>
#include <cfloat>
#include <limits>

#include "math/float4.h"

namespace kiwami {
namespace {

/// The top of the tree is opened until there are so many subtrees, which are refitted side by side.
/// It does not depend on the number of threads, nor do the sums of costs.
constexpr size_t kSubtreeCount = 1024;
/// Subtrees that one task refits.
constexpr size_t kSubtreesPerTask = 8;
/// How many leaves before its turn the ids of one are fetched into the caches, then the indices of
/// its triangles, then their vertices: each names where the next lies.
constexpr size_t kIdsAhead = 24, kIndicesAhead = 16, kVerticesAhead = 8;
/// The frame is chosen anew when the tree reaches so many times as far from its centre as it would
/// from its own: then its boxes lose digits, and the margins of its rays are needlessly wide.
constexpr float kFrameSlack = 4.0f;

/// What a subtree adds up to.
struct Totals {
  TreeAreas areas;
  uint64_t vanished_lanes = 0;

  void add(const Totals& other) {
    areas.node_area += other.areas.node_area;
    areas.leaf_area += other.areas.leaf_area;
    areas.node_count += other.areas.node_count;
    areas.leaf_count += other.areas.leaf_count;
    vanished_lanes += other.vanished_lanes;
  }
};

/// The corners of triangles by id; triangles of one mesh mostly follow each other.
class CornerReader {
 public:
  explicit CornerReader(const TriangleSource& source) : source_(source), mesh_(&source.meshes[0]) {}

  /// False for a triangle that can not be hit. Throws as checked_corners_of.
  bool read(uint32_t id, Float4 corner[3]) {
    if (id - mesh_->first_id >= mesh_->triangle_count) mesh_ = &source_.mesh_of(id);
    uint32_t index[3];
    mesh_->checked_indices_of(id - mesh_->first_id, index);
    for (int k = 0; k < 3; ++k) {
      corner[k] = load3(mesh_->vertices + index[k] * mesh_->vertex_stride);
    }
    return is_in_range(corner[0], corner[1], corner[2]);
  }

  // Hints for triangles that are read soon: of the mesh of the last one alone. Inlined by force: GCC
  // takes a function that only prefetches for one without effects and drops it.
  __attribute__((always_inline)) void prefetch_indices(uint32_t id) const {
    const uint32_t primitive = id - mesh_->first_id;
    if (primitive >= mesh_->triangle_count || !mesh_->indices) return;
    prefetch_element(mesh_->indices + primitive * mesh_->index_stride);
  }
  __attribute__((always_inline)) void prefetch_vertices(uint32_t id) const {
    const uint32_t primitive = id - mesh_->first_id;
    if (primitive >= mesh_->triangle_count) return;
    uint32_t index[3];
    mesh_->indices_of(primitive, index);
    for (const uint32_t vertex : index) {
      if (vertex >= mesh_->vertex_count) continue;
      prefetch_element(mesh_->vertices + vertex * mesh_->vertex_stride);
    }
  }

 private:
  /// Its 12 bytes may stand in two lines.
  __attribute__((always_inline)) static void prefetch_element(const unsigned char* element) {
    __builtin_prefetch(element);
    __builtin_prefetch(element + 11);
  }

  /// What can_be_hit says.
  static bool is_in_range(Float4 a, Float4 b, Float4 c) {
    constexpr float limit = KIWAMI_MAX_COORDINATE;
    constexpr Float4 upper = {limit, limit, limit, limit};
    return is_true_everywhere((a <= upper) & (b <= upper) & (c <= upper) & (a >= -upper) &
                              (b >= -upper) & (c >= -upper));
  }

  const TriangleSource& source_;
  const TriangleMeshView* mesh_;
};

template <int N>
class WideRefit {
 public:
  WideRefit(WideTree& tree, const TriangleSource& source, Memory& memory)
      : tree_(tree), source_(source), memory_(memory), nodes_(tree.nodes<N>()), entries_(memory) {}

  /// The box of the whole tree.
  Bounds run(const Parallel& parallel) {
    centre_ = load3(&tree_.view.centre);
    open_top();
    const size_t first = opened_, count = entries_.size() - opened_;
    parallel.for_blocks(count, kSubtreesPerTask, [&](size_t begin, size_t end) {
      GrowingArray<ChildReference> leaves(memory_);
      for (size_t i = first + begin; i < first + end; ++i) {
        collect_leaves(entries_[i].reference, leaves);
      }
      Array<Bounds4> boxes(memory_, leaves.size());
      Totals& totals = entries_[first + begin].totals;
      totals = {};
      refit_leaves(leaves, boxes, totals);
      const Bounds4* next = boxes.begin();
      for (size_t i = first + begin; i < first + end; ++i) {
        entries_[i].box = refit(entries_[i].reference, next, totals);
      }
    });
    totals_ = {};
    for (size_t i = 0; i < count; i += kSubtreesPerTask) totals_.add(entries_[first + i].totals);
    // Parents stand before their children.
    for (size_t i = opened_; i-- > 0;) close(entries_[i]);
    return entries_[0].box.bounds();
  }

  const Totals& totals() const { return totals_; }

 private:
  /// A reference of the top of the tree. Those that are opened stand before the others.
  struct Entry {
    ChildReference reference;
    size_t first_child;  ///< of an opened one: its slots' entries are from here on, by slot
    Bounds4 box;
    Totals totals;  ///< of its task, in the first entry of that
  };

  /// Opens references breadth first, up to a leaf or to the number of subtrees.
  void open_top() {
    if (!entries_.empty()) return;
    entries_.push_back({tree_.view.root, 0, Bounds4::empty(), {}});
    while (opened_ < entries_.size() && entries_.size() < kSubtreeCount &&
           !entries_[opened_].reference.is_leaf()) {
      Entry& entry = entries_[opened_];
      entry.first_child = entries_.size();
      const WideNode<N>& node = node_of(entry.reference);
      for (uint32_t mask = entry.reference.mask(); mask != 0; mask &= mask - 1) {
        entries_.push_back({node.child[std::countr_zero(mask)], 0, Bounds4::empty(), {}});
      }
      ++opened_;
    }
  }

  WideNode<N>& node_of(ChildReference reference) const {
    return nodes_[reference.node_offset() / sizeof(WideNode<N>)];
  }

  void close(Entry& entry) {
    WideNode<N>& node = node_of(entry.reference);
    size_t child = entry.first_child;
    Bounds4 box = Bounds4::empty();
    for (uint32_t mask = entry.reference.mask(); mask != 0; mask &= mask - 1, ++child) {
      const Bounds4& below = entries_[child].box;
      set_box(node, std::countr_zero(mask), below);
      box.extend(below);
    }
    entry.box = box;
    count_node(box, totals_);
  }

  /// In the order in which refit meets them.
  void collect_leaves(ChildReference reference, GrowingArray<ChildReference>& leaves) const {
    if (reference.is_leaf()) {
      leaves.push_back(reference);
      return;
    }
    const WideNode<N>& node = node_of(reference);
    for (uint32_t mask = reference.mask(); mask != 0; mask &= mask - 1) {
      const ChildReference child = node.child[std::countr_zero(mask)];
      if (!child.is_leaf()) prefetch(&node_of(child), sizeof(WideNode<N>));
    }
    for (uint32_t mask = reference.mask(); mask != 0; mask &= mask - 1) {
      collect_leaves(node.child[std::countr_zero(mask)], leaves);
    }
  }

  __attribute__((always_inline)) static void prefetch(const void* address, size_t bytes) {
    constexpr size_t kLine = 64;
    for (size_t i = 0; i < bytes; i += kLine) {
      __builtin_prefetch(static_cast<const char*>(address) + i, 1);
    }
  }

  /// One after the other, each fetched from memory step by step while others are computed.
  void refit_leaves(const GrowingArray<ChildReference>& leaves, Array<Bounds4>& boxes,
                    Totals& totals) const {
    CornerReader corners(source_);
    const size_t count = leaves.size();
    for (size_t turn = 0; turn < count + kIdsAhead; ++turn) {
      if (turn < count) {
        prefetch(tree_.template blocks<unsigned char>() +
                     tree_.number_of(leaves[turn]) * tree_.leaf_block_bytes(),
                 tree_.leaf_block_bytes());
      }
      const size_t behind_ids = turn - (kIdsAhead - kIndicesAhead);
      if (behind_ids < count) {
        for_each_id(
            leaves[behind_ids], [&](uint32_t id) __attribute__((always_inline)) {
              corners.prefetch_indices(id);
            });
      }
      const size_t behind_indices = turn - (kIdsAhead - kVerticesAhead);
      if (behind_indices < count) {
        for_each_id(
            leaves[behind_indices], [&](uint32_t id) __attribute__((always_inline)) {
              corners.prefetch_vertices(id);
            });
      }
      const size_t now = turn - kIdsAhead;
      if (now < count) boxes[now] = refit_leaf(leaves[now], corners, totals);
    }
  }

  template <typename Visit>
  __attribute__((always_inline)) void for_each_id(ChildReference reference, Visit&& visit) const {
    const uint32_t* const ids = tree_.leaf_ids(tree_.number_of(reference));
    for (uint32_t mask = reference.mask(); mask != 0; mask &= mask - 1) {
      visit(ids[std::countr_zero(mask)]);
    }
  }

  /// The boxes of the leaves below a reference are the next ones.
  Bounds4 refit(ChildReference reference, const Bounds4*& next_leaf, Totals& totals) const {
    if (reference.is_leaf()) return *next_leaf++;
    WideNode<N>& node = node_of(reference);
    Bounds4 box = Bounds4::empty();
    for (uint32_t mask = reference.mask(); mask != 0; mask &= mask - 1) {
      const int slot = std::countr_zero(mask);
      const Bounds4 below = refit(node.child[slot], next_leaf, totals);
      set_box(node, slot, below);
      box.extend(below);
    }
    count_node(box, totals);
    return box;
  }

  /// Other owners' lanes of the block are not touched.
  Bounds4 refit_leaf(ChildReference reference, CornerReader& corners, Totals& totals) const {
    const uint64_t number = tree_.number_of(reference);
    const uint32_t* const ids = tree_.leaf_ids(number);
    Bounds4 box = Bounds4::empty();
    for (uint32_t mask = reference.mask(); mask != 0; mask &= mask - 1) {
      const int lane = std::countr_zero(mask);
      Float4 corner[3];
      if (corners.read(ids[lane], corner)) {
        box.extend({min_keep(min_keep(corner[0], corner[1]), corner[2]),
                    max_keep(max_keep(corner[0], corner[1]), corner[2])});
      } else {
        constexpr float nan = std::numeric_limits<float>::quiet_NaN();
        for (Float4& vertex : corner) vertex = Float4{nan, nan, nan, nan};
        ++totals.vanished_lanes;
      }
      if (tree_.leaf_layout == LeafLayout::kTriangles) {
        store(corner, tree_.template leaves<N>()[number], lane);
      }
    }
    totals.areas.leaf_area += static_cast<double>(box.bounds().half_area());
    ++totals.areas.leaf_count;
    return box;
  }

  static void store(const Float4 corner[3], LeafBlock<N>& block, int lane) {
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (int axis = 0; axis < 3; ++axis) {
        block.position[vertex][axis][lane] = corner[vertex][axis];
      }
    }
  }

  static void count_node(const Bounds4& box, Totals& totals) {
    totals.areas.node_area += static_cast<double>(box.bounds().half_area());
    ++totals.areas.node_count;
  }

  void set_box(WideNode<N>& node, int slot, const Bounds4& box) const {
    // A box around nothing has infinite corners on all axes.
    const bool is_empty = !(box.lower[0] <= box.upper[0]);
    const Float4 lower = subtract_down(box.lower, centre_);
    const Float4 upper = subtract_up(box.upper, centre_);
    for (int axis = 0; axis < 3; ++axis) {
      node.bounds[axis][0][slot] = is_empty ? FLT_MAX : lower[axis];
      node.bounds[axis][1][slot] = is_empty ? -FLT_MAX : upper[axis];
    }
  }

  WideTree& tree_;
  const TriangleSource& source_;
  Memory& memory_;
  WideNode<N>* nodes_;
  Float4 centre_{};
  GrowingArray<Entry> entries_;
  size_t opened_ = 0;  ///< entries that are opened
  Totals totals_;
};

float greatest_of(const Vec3f& bound) { return std::max({bound.x, bound.y, bound.z}); }

template <int N>
RefitResult refit(WideTree& tree, const TriangleSource& source, double node_cost, double leaf_cost,
                  Memory& memory, const Parallel& parallel) {
  RefitResult result;
  WideRefit<N> refit(tree, source, memory);
  const Bounds box = result.bounds = refit.run(parallel);
  TreeView& view = tree.view;
  if (box.is_empty()) {
    view.greatest_bound = {0.0f, 0.0f, 0.0f};
  } else {
    TreeView framed = view;
    set_frame(box, framed);
    view.greatest_bound = reach_of(box, view.centre);
    if (greatest_of(view.greatest_bound) > kFrameSlack * greatest_of(framed.greatest_bound)) {
      view = framed;
      refit.run(parallel);
    }
  }
  result.vanished_lanes = refit.totals().vanished_lanes;
  tree.sah_cost = relative_cost(refit.totals().areas, box, node_cost, leaf_cost);
  return result;
}

}  // namespace

RefitResult refit_wide_tree(WideTree& tree, const TriangleSource& source, double node_cost,
                            double leaf_cost, Memory& memory, const Parallel& parallel) {
  if (tree.view.root.mask() == 0) return {};
  switch (tree.width) {
    case 4:
      return refit<4>(tree, source, node_cost, leaf_cost, memory, parallel);
    case 8:
      return refit<8>(tree, source, node_cost, leaf_cost, memory, parallel);
    default:
      return refit<16>(tree, source, node_cost, leaf_cost, memory, parallel);
  }
}

}  // namespace kiwami
