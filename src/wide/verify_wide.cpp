// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cfloat>
#include <cmath>
#include <cstring>

#include "bvh/triangle_cover.h"
#include "core/error.h"
#include "math/rounding.h"
#include "wide/wide_tree.h"

namespace kiwami {
namespace {

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  if constexpr (sizeof...(values) == 0) {
    throw Error(KIWAMI_ERROR_VALIDATION, "%s", format);
  } else {
    throw Error(KIWAMI_ERROR_VALIDATION, format, values...);
  }
}

/// What a tree was built over: triangles, or boxes by rising id.
struct Primitives {
  const TriangleSource* source;  ///< nullptr: boxes
  std::span<const BuildPrimitive> boxes;
  uint64_t count;  ///< of those that the tree holds

  const char* name() const { return source ? "triangle" : "primitive"; }

  /// All ids are below this.
  size_t id_limit() const {
    if (!source) return boxes.empty() ? 0 : size_t{boxes.back().id} + 1;
    if (source->mesh_count == 0) return 0;
    const TriangleMeshView& last = source->meshes[source->mesh_count - 1];
    return size_t{last.first_id} + last.triangle_count;
  }

  /// The box of an id; nullptr where there is none.
  const BuildPrimitive* find_box(uint32_t id) const {
    const auto found = std::lower_bound(
        boxes.begin(), boxes.end(), id,
        [](const BuildPrimitive& box, uint32_t wanted) { return box.id < wanted; });
    return found != boxes.end() && found->id == id ? &*found : nullptr;
  }
};

/// The walk over one tree, path by path.
template <int N>
class WideVerifier {
 public:
  WideVerifier(const WideTree& tree, const Primitives& primitives, Memory& memory)
      : tree_(tree),
        primitives_(primitives),
        memory_(memory),
        nodes_(tree.nodes<N>()),
        owned_slots_(memory, tree.node_count),
        owned_lanes_(memory, tree.leaf_block_count),
        has_primitive_(memory, primitives.id_limit()),
        parts_(memory),
        stack_(memory) {
    owned_slots_.fill_zero();
    owned_lanes_.fill_zero();
    has_primitive_.fill_zero();
  }

  void run() {
    check_sizes();
    check_view();
    if (tree_.view.root.mask() != 0) walk();
    check_parts();
    check_unused();
    check_totals();
  }

 private:
  /// A child reference, the box that its parent stores for it, and where that stands.
  struct Visit {
    ChildReference reference;
    uint32_t depth;
    uint32_t parent;
    Bounds box;
  };

  /// A leaf around a part of a triangle.
  struct Part {
    uint32_t id;
    uint32_t block;
    Bounds box;
  };

  bool has_positions() const { return tree_.leaf_layout == LeafLayout::kTriangles; }
  const LeafBlock<N>& leaf(uint32_t block) const { return tree_.leaves<N>()[block]; }
  uint32_t id_of(uint32_t block, int lane) const { return tree_.leaf_ids(block)[lane]; }

  void check_sizes() const {
    if (tree_.leaf_width != tree_.width) {
      fail("the leaf width is %u, expected the node width %u", tree_.leaf_width, tree_.width);
    }
    if (tree_.view.leaf_layout != tree_.leaf_layout) {
      fail("the view's leaf layout is %u, expected the tree's, which is %u",
           static_cast<uint32_t>(tree_.view.leaf_layout), static_cast<uint32_t>(tree_.leaf_layout));
    }
    if (has_positions() && !primitives_.source && primitives_.count != 0) {
      fail("the leaves of a tree over boxes hold triangles, expected ids alone");
    }
    if (tree_.memory.size() != tree_.node_bytes() + tree_.leaf_bytes() ||
        tree_.view.memory != tree_.memory.data() ||
        tree_.view.memory_bytes != tree_.memory.size()) {
      fail("%zu bytes do not hold %llu nodes and %llu leaf blocks", tree_.memory.size(),
           static_cast<unsigned long long>(tree_.node_count),
           static_cast<unsigned long long>(tree_.leaf_block_count));
    }
  }

  void check_view() const {
    const TreeView& view = tree_.view;
    for (int axis = 0; axis < 3; ++axis) {
      if (!std::isfinite(view.centre[axis])) {
        fail("the centre on axis %d is %g, expected a finite number", axis,
             static_cast<double>(view.centre[axis]));
      }
      if (!std::isfinite(view.greatest_bound[axis]) || view.greatest_bound[axis] < 0.0f) {
        fail("the greatest bound on axis %d is %g, expected a finite number of at least 0", axis,
             static_cast<double>(view.greatest_bound[axis]));
      }
    }
  }

  void walk() {
    const Vec3f limit = tree_.view.greatest_bound;
    const Bounds root_box = {{-limit.x, -limit.y, -limit.z}, limit};
    stack_.push_back({tree_.view.root, 0, KIWAMI_INVALID_ID, root_box});
    while (!stack_.empty()) {
      const Visit visit = stack_.back();
      stack_.pop_back();
      if (visit.reference.is_leaf()) {
        visit_leaf(visit);
      } else {
        visit_node(visit);
      }
    }
  }

  /// The number of the node (leaf block) that a visit refers to, whose slots (lanes) it marks as
  /// owned.
  uint32_t claim(const char* what, const Visit& visit, uint64_t count, size_t size, uint64_t first,
                 Array<uint16_t>& owned) const {
    const uint64_t offset = visit.reference.offset();
    const uint32_t parent = visit.parent;
    if (offset < first || offset - first >= count * size || (offset - first) % size != 0) {
      fail("node %u refers to byte %llu as a %s, expected one of %llu of %zu bytes from byte %llu",
           parent, static_cast<unsigned long long>(offset), what,
           static_cast<unsigned long long>(count), size, static_cast<unsigned long long>(first));
    }
    const auto index = static_cast<uint32_t>((offset - first) / size);
    const uint32_t mask = visit.reference.mask();
    if (mask == 0 || (mask >> N) != 0) {
      fail("node %u refers to %s %u with mask 0x%x, expected some of %d bits", parent, what, index,
           mask, N);
    }
    if (owned[index] & mask) {
      fail("node %u refers to %s %u with mask 0x%x, of which others own 0x%x", parent, what, index,
           mask, owned[index] & mask);
    }
    owned[index] = static_cast<uint16_t>(owned[index] | mask);
    return index;
  }

  void visit_node(const Visit& visit) {
    const uint32_t index =
        claim("node", visit, tree_.node_count, sizeof(WideNode<N>), 0, owned_slots_);
    const uint32_t depth = visit.depth + 1;
    if (depth > kMaxWideDepth) {
      fail("node %u is at depth %u, expected at most %u", index, depth, kMaxWideDepth);
    }
    depth_ = depth > depth_ ? depth : depth_;
    const WideNode<N>& node = nodes_[index];
    for (uint32_t mask = visit.reference.mask(); mask != 0; mask &= mask - 1) {
      const int slot = std::countr_zero(mask);
      Bounds box;
      for (int axis = 0; axis < 3; ++axis) {
        box.lower[axis] = node.bounds[axis][0][slot];
        box.upper[axis] = node.bounds[axis][1][slot];
      }
      // A refit leaves the box of an unused slot around triangles that can not be hit any more.
      if (box.is_empty() && !has_unused_box(node, slot)) {
        fail("the box of slot %d of node %u is empty", slot, index);
      }
      if (!visit.box.contains(box)) {
        fail("the box of slot %d of node %u leaves the box that its parent, node %u, stores", slot,
             index, visit.parent);
      }
      ++used_slots_;
      stack_.push_back({node.child[slot], depth, index, box});
    }
  }

  void visit_leaf(const Visit& visit) {
    const uint32_t index = claim("leaf block", visit, tree_.leaf_block_count,
                                 tree_.leaf_block_bytes(), tree_.node_bytes(), owned_lanes_);
    for (uint32_t mask = visit.reference.mask(); mask != 0; mask &= mask - 1) {
      const int lane = std::countr_zero(mask);
      const uint32_t id = id_of(index, lane);
      check_id(index, lane);
      for (uint32_t rest = mask & (mask - 1); rest != 0; rest &= rest - 1) {
        if (id_of(index, std::countr_zero(rest)) != id) continue;
        fail("%s %u stands in two lanes of one leaf in leaf block %u", primitives_.name(), id,
             index);
      }
      if (primitives_.source) {
        check_triangle(index, lane, visit.box);
      } else {
        check_box(index, lane, visit.box);
      }
      ++used_lanes_;
    }
  }

  void check_id(uint32_t block, int lane) {
    const uint32_t id = id_of(block, lane);
    if (id >= has_primitive_.size()) {
      fail("lane %d of leaf block %u has id %u, expected below %zu", lane, block, id,
           has_primitive_.size());
    }
    if (has_primitive_[id] && !tree_.view.has_duplicates) {
      fail("%s %u stands in two lanes", primitives_.name(), id);
    }
    if (!has_primitive_[id]) has_primitive_[id] = kSeen;
  }

  /// Whether a leaf's box, in the stored frame, holds an interval of an axis.
  bool holds(const Bounds& box, int axis, float lower, float upper) const {
    const float centre = tree_.view.centre[axis];
    return box.lower[axis] <= subtract_down(lower, centre) &&
           subtract_up(upper, centre) <= box.upper[axis];
  }

  void check_triangle(uint32_t block, int lane, const Bounds& box) {
    const uint32_t id = id_of(block, lane);
    Vec3f corner[3];
    primitives_.source->corners_of(id, corner);
    if (!can_be_hit(corner)) {
      check_vanished(block, lane);
      return;
    }
    bool is_part = false;
    for (int vertex = 0; vertex < 3; ++vertex) {
      for (int axis = 0; axis < 3; ++axis) {
        const float original = corner[vertex][axis];
        if (has_positions() &&
            std::memcmp(&leaf(block).position[vertex][axis][lane], &original, sizeof(float)) != 0) {
          fail("vertex %d of triangle %u in leaf block %u is not the original one", vertex, id,
               block);
        }
        if (holds(box, axis, original, original)) continue;
        is_part = true;
        if (!tree_.view.has_duplicates) {
          fail("triangle %u in leaf block %u leaves its box on axis %d", id, block, axis);
        }
      }
    }
    count(id);
    if (is_part) {
      parts_.push_back({id, block, box});
    } else {
      has_primitive_[id] = kWhole;
    }
  }

  void check_box(uint32_t block, int lane, const Bounds& box) {
    const uint32_t id = id_of(block, lane);
    const BuildPrimitive* const own = primitives_.find_box(id);
    if (!own) fail("lane %d of leaf block %u has id %u, which no primitive has", lane, block, id);
    for (int axis = 0; axis < 3; ++axis) {
      if (!holds(box, axis, own->lower[axis], own->upper[axis])) {
        fail("primitive %u in leaf block %u leaves its box on axis %d", id, block, axis);
      }
    }
    count(id);
    has_primitive_[id] = kWhole;
  }

  void count(uint32_t id) {
    if (has_primitive_[id] != kSeen) return;
    has_primitive_[id] = kInParts;
    ++primitive_count_;
  }

  /// A triangle that can not be hit any more stands as NaN where it stood.
  void check_vanished(uint32_t block, int lane) const {
    for (int i = 0; has_positions() && i < 9; ++i) {
      if (std::isnan(leaf(block).position[i / 3][i % 3][lane])) continue;
      fail("triangle %u in leaf block %u can not be hit, expected NaN in its lane",
           id_of(block, lane), block);
    }
  }

  /// Of each triangle that no leaf box holds, the boxes around its parts must cover it.
  void check_parts() {
    Array<Part> parts = parts_.take();
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
      return a.id < b.id || (a.id == b.id && a.block < b.block);
    });
    for (const Part *begin = parts.begin(), *end = begin; begin != parts.end(); begin = end) {
      while (end != parts.end() && end->id == begin->id) ++end;
      if (has_primitive_[begin->id] == kWhole) continue;
      Array<Bounds> boxes(memory_, static_cast<size_t>(end - begin));
      for (size_t i = 0; i < boxes.size(); ++i) boxes[i] = begin[i].box;
      Vec3f corner[3];
      primitives_.source->corners_of(begin->id, corner);
      if (!is_covered(corner, tree_.view.centre, {boxes.data(), boxes.size()})) {
        fail("the boxes of leaves do not cover triangle %u, which stands in leaf block %u",
             begin->id, begin->block);
      }
    }
  }

  void check_unused() const {
    constexpr uint32_t kAll = (1u << N) - 1;
    for (uint32_t i = 0; i < tree_.node_count; ++i) {
      for (uint32_t mask = kAll & ~owned_slots_[i]; mask != 0; mask &= mask - 1) {
        check_unused_slot(i, std::countr_zero(mask));
      }
    }
    for (uint32_t i = 0; i < tree_.leaf_block_count; ++i) {
      for (uint32_t mask = kAll & ~owned_lanes_[i]; mask != 0; mask &= mask - 1) {
        check_unused_lane(i, std::countr_zero(mask));
      }
    }
  }

  void check_unused_slot(uint32_t index, int slot) const {
    const WideNode<N>& node = nodes_[index];
    if (node.child[slot].bits != 0 || !has_unused_box(node, slot)) {
      fail("slot %d of node %u has contents but no owner", slot, index);
    }
  }

  static bool has_unused_box(const WideNode<N>& node, int slot) {
    for (int axis = 0; axis < 3; ++axis) {
      if (node.bounds[axis][0][slot] != FLT_MAX || node.bounds[axis][1][slot] != -FLT_MAX) {
        return false;
      }
    }
    return true;
  }

  void check_unused_lane(uint32_t index, int lane) const {
    bool is_unused = id_of(index, lane) == KIWAMI_INVALID_ID;
    for (int i = 0; has_positions() && i < 9; ++i) {
      is_unused = is_unused && std::isnan(leaf(index).position[i / 3][i % 3][lane]);
    }
    if (!is_unused) fail("lane %d of leaf block %u has contents but no owner", lane, index);
  }

  void check_totals() const {
    const struct {
      const char* what;
      uint64_t stated, counted;
    } totals[] = {
        {"used slots", tree_.used_slots, used_slots_},
        {"used lanes", tree_.used_lanes, used_lanes_},
        {"levels", tree_.depth, depth_},
        {primitives_.source ? "triangles" : "primitives", primitives_.count, primitive_count_}};
    for (const auto& total : totals) {
      if (total.stated != total.counted) {
        fail("the tree has %llu %s, expected %llu", static_cast<unsigned long long>(total.counted),
             total.what, static_cast<unsigned long long>(total.stated));
      }
    }
  }

  const WideTree& tree_;
  const Primitives& primitives_;
  Memory& memory_;
  const WideNode<N>* nodes_;
  Array<uint16_t> owned_slots_;
  Array<uint16_t> owned_lanes_;
  /// Of has_primitive_, for a primitive that stands in some lane: as NaN so far, in boxes around
  /// parts of it, in a box around all of it.
  static constexpr uint8_t kSeen = 1, kInParts = 2, kWhole = 3;

  Array<uint8_t> has_primitive_;
  GrowingArray<Part> parts_;
  GrowingArray<Visit> stack_;
  uint64_t used_slots_ = 0;
  uint64_t used_lanes_ = 0;
  uint64_t primitive_count_ = 0;
  uint32_t depth_ = 0;
};

void verify(const WideTree& tree, const Primitives& primitives, Memory& memory) {
  switch (tree.width) {
    case 4:
      return WideVerifier<4>(tree, primitives, memory).run();
    case 8:
      return WideVerifier<8>(tree, primitives, memory).run();
    case 16:
      return WideVerifier<16>(tree, primitives, memory).run();
    default:
      fail("the tree's width is %u, expected 4, 8 or 16", tree.width);
  }
}

}  // namespace

void verify_wide_tree(const WideTree& tree, const TriangleSource& source, uint64_t primitive_count,
                      Memory& memory) {
  verify(tree, {&source, {}, primitive_count}, memory);
}

void verify_wide_tree(const WideTree& tree, std::span<const BuildPrimitive> boxes, Memory& memory) {
  verify(tree, {nullptr, boxes, boxes.size()}, memory);
}

}  // namespace kiwami
