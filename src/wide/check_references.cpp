// SPDX-License-Identifier: Apache-2.0
#include "wide/check_references.h"

#include <bit>
#include <cmath>

#include "core/error.h"
#include "kiwami/base.h"
#include "wide/slot_owners.h"

namespace kiwami {
namespace {

/// Leaf blocks that one task checks.
constexpr size_t kBlockSize = 4096;

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

template <int N>
class ReferenceChecker {
 public:
  ReferenceChecker(const WideTree& tree, const ReferenceLimits& limits, Memory& memory)
      : tree_(tree),
        limits_(limits),
        owned_slots_(owned_array(limits.owned, tree.node_count, memory)),
        owned_lanes_(owned_array(limits.owned ? limits.owned + tree.node_count : nullptr,
                                 tree.leaf_block_count, memory)),
        stack_(memory) {
    owned_slots_.fill_zero();
    owned_lanes_.fill_zero();
  }

  void run(const Parallel& parallel) {
    check_frame();
    if (tree_.view.root.mask() != 0) visit({tree_.view.root, 0}, KIWAMI_INVALID_ID);
    while (!stack_.empty()) {
      const Visit node = stack_.back();
      stack_.pop_back();
      check_slots(node);
    }
    parallel.for_blocks(tree_.leaf_block_count, kBlockSize, [this](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) check_lanes(i);
    });
    check_total("used slots", tree_.used_slots, used_slots_);
    check_total("used lanes", tree_.used_lanes, used_lanes_);
    check_total("levels", tree_.depth, depth_);
  }

 private:
  struct Visit {
    ChildReference reference;
    uint32_t depth;  ///< nodes above it
  };

  static Array<uint16_t> owned_array(uint16_t* given, uint64_t count, Memory& memory) {
    return given ? Array<uint16_t>::borrow(given, count) : Array<uint16_t>(memory, count);
  }

  void check_frame() const {
    for (int axis = 0; axis < 3; ++axis) {
      const float centre = tree_.view.centre[axis], bound = tree_.view.greatest_bound[axis];
      // The greatest bound of what lies within the limit on both sides, with some padding.
      const float most = limits_.greatest_coordinate;
      if (std::abs(centre) <= most && bound >= 0.0f && bound <= 2.0f * most) {
        continue;
      }
      fail(
          "the frame of the tree has its centre at %g and reaches to %g on axis %d, expected "
          "finite numbers",
          static_cast<double>(centre), static_cast<double>(bound), axis);
    }
  }

  /// Claims what a reference owns; of a node, its slots are still to be checked.
  void visit(const Visit& to, uint32_t parent) {
    if (to.reference.is_leaf()) {
      used_lanes_ += claim("leaf block", to.reference, parent, tree_.node_bytes(),
                           tree_.leaf_block_bytes(), owned_lanes_);
      return;
    }
    if (to.depth == kMaxWideDepth) {
      fail("a child of node %u has %u nodes above it, expected less than %u", parent, to.depth,
           kMaxWideDepth);
    }
    claim("node", to.reference, parent, 0, sizeof(WideNode<N>), owned_slots_);
    depth_ = std::max(depth_, to.depth + 1);
    stack_.push_back(to);
  }

  /// Returns how many slots (lanes) the reference owns.
  uint32_t claim(const char* what, ChildReference reference, uint32_t parent, uint64_t first,
                 size_t size, Array<uint16_t>& owned) const {
    const uint64_t offset = reference.offset();
    if (offset < first || (offset - first) % size != 0 || (offset - first) / size >= owned.size()) {
      fail("node %u refers to byte %llu as a %s, expected one of %zu of %zu bytes from byte %llu",
           parent, ull{offset}, what, owned.size(), size, ull{first});
    }
    const uint64_t index = (offset - first) / size;
    const uint32_t mask = reference.mask();
    if (mask == 0 || (mask >> N) != 0 || (owned[index] & mask) != 0) {
      fail("node %u refers to %s %llu with mask 0x%x, expected some of the bits of 0x%x", parent,
           what, ull{index}, mask, ((1u << N) - 1) & ~uint32_t{owned[index]});
    }
    owned[index] = static_cast<uint16_t>(owned[index] | mask);
    return static_cast<uint32_t>(std::popcount(mask));
  }

  void check_slots(const Visit& of) {
    const auto index = static_cast<uint32_t>(tree_.number_of(of.reference));
    const WideNode<N>& node = tree_.nodes<N>()[index];
    for (uint32_t mask = of.reference.mask(); mask != 0; mask &= mask - 1) {
      const int slot = std::countr_zero(mask);
      if (!is_within_frame(box_of(node, slot))) {
        fail("the box of slot %d of node %u is empty or reaches beyond the tree's frame", slot,
             index);
      }
      ++used_slots_;
      visit({node.child[slot], of.depth + 1}, index);
    }
  }

  bool is_within_frame(const Bounds& box) const {
    const Vec3f& limit = tree_.view.greatest_bound;
    bool is_within = true;
    for (int axis = 0; axis < 3; ++axis) {
      // False where one is NaN.
      is_within = is_within && -limit[axis] <= box.lower[axis] &&
                  box.lower[axis] <= box.upper[axis] && box.upper[axis] <= limit[axis];
    }
    return is_within;
  }

  void check_lanes(size_t index) const {
    const uint32_t* const ids = tree_.leaf_ids(index);
    for (uint32_t mask = owned_lanes_[index]; mask != 0; mask &= mask - 1) {
      const int lane = std::countr_zero(mask);
      if (!contains(limits_.ids, ids[lane])) {
        const IdRange last = limits_.ids.empty() ? IdRange{0, 0} : limits_.ids.back();
        fail(
            "lane %d of leaf block %zu has id %u, expected one of what the tree is over, less than "
            "%llu",
            lane, index, ids[lane], ull{last.first + last.count});
      }
      if (tree_.leaf_layout == LeafLayout::kTriangles) check_vertices(index, lane);
    }
  }

  void check_vertices(size_t index, int lane) const {
    const LeafBlock<N>& leaf = tree_.leaves<N>()[index];
    for (int i = 0; i < 9; ++i) {
      const float value = leaf.position[i / 3][i % 3][lane];
      // False where it is NaN.
      if (std::abs(value) <= limits_.greatest_coordinate) continue;
      fail("lane %d of leaf block %zu has a vertex at %g on axis %d, expected at most 2^60", lane,
           index, static_cast<double>(value), i % 3);
    }
  }

  void check_total(const char* what, uint64_t stated, uint64_t counted) const {
    if (stated == counted) return;
    fail("the tree has %llu %s, expected %llu", ull{counted}, what, ull{stated});
  }

  const WideTree& tree_;
  ReferenceLimits limits_;
  Array<uint16_t> owned_slots_;
  Array<uint16_t> owned_lanes_;
  GrowingArray<Visit> stack_;
  uint64_t used_slots_ = 0;
  uint64_t used_lanes_ = 0;
  uint32_t depth_ = 0;
};

}  // namespace

bool contains(std::span<const IdRange> ranges, uint64_t id) {
  const auto next =
      std::upper_bound(ranges.begin(), ranges.end(), id,
                       [](uint64_t value, const IdRange& range) { return value < range.first; });
  return next != ranges.begin() && id - (next - 1)->first < (next - 1)->count;
}

void check_references(const WideTree& tree, const ReferenceLimits& limits, Memory& memory,
                      const Parallel& parallel) {
  with_width(tree.width, [&](auto width) {
    ReferenceChecker<decltype(width)::value>(tree, limits, memory).run(parallel);
  });
}

}  // namespace kiwami
