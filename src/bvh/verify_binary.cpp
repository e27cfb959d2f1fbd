// SPDX-License-Identifier: Apache-2.0
#include "bvh/verify_binary.h"

#include <algorithm>
#include <utility>

#include "core/error.h"

namespace kiwami {
namespace {

bool is_equal(const Bounds& a, const Bounds& b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (a.lower[axis] != b.lower[axis] || a.upper[axis] != b.upper[axis]) return false;
  }
  return true;
}

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_VALIDATION, format, values...);
}

/// The walk over one tree.
class BinaryVerifier {
 public:
  BinaryVerifier(const BinaryBvh& bvh, const BuildPrimitive* primitives, size_t count,
                 uint32_t max_leaf_size, Memory& memory)
      : bvh_(bvh),
        primitives_(primitives),
        count_(count),
        max_leaf_size_(max_leaf_size),
        by_id_(memory, count),
        is_owned_(memory, count),
        is_visited_(memory, bvh.nodes.size()) {
    is_owned_.fill_zero();
    is_visited_.fill_zero();
  }

  void run() {
    if (bvh_.primitive_ids.size() != count_) {
      fail("the tree has %zu primitive ids, expected %zu", bvh_.primitive_ids.size(), count_);
    }
    if (count_ == 0) {
      if (!bvh_.nodes.empty()) fail("a tree over no primitives has %zu nodes", bvh_.nodes.size());
      return;
    }
    if (bvh_.nodes.empty()) fail("the tree over %zu primitives has no nodes", count_);
    sort_by_id();
    walk();
    for (size_t i = 0; i < count_; ++i) {
      if (!is_owned_[i]) fail("primitive id %u is in no leaf", primitives_[by_id_[i]].id);
    }
  }

 private:
  struct Visit {
    uint32_t node, depth;
  };

  void sort_by_id() {
    for (size_t i = 0; i < count_; ++i) by_id_[i] = static_cast<uint32_t>(i);
    std::sort(by_id_.begin(), by_id_.end(),
              [this](uint32_t a, uint32_t b) { return primitives_[a].id < primitives_[b].id; });
    for (size_t i = 1; i < count_; ++i) {
      const uint32_t id = primitives_[by_id_[i]].id;
      if (primitives_[by_id_[i - 1]].id == id) fail("primitive id %u was given twice", id);
    }
  }

  void walk() {
    // Each visit pushes two and pops one, and no path is longer than kMaxDepth.
    Visit stack[BinaryBvh::kMaxDepth + 1];
    size_t size = 0;
    stack[size++] = {0, 1};
    is_visited_[0] = 1;
    while (size) {
      const Visit visit = stack[--size];
      const BinaryNode& node = bvh_.nodes[visit.node];
      if (visit.depth > BinaryBvh::kMaxDepth) {
        fail("node %u is at depth %u, expected at most %u", visit.node, visit.depth,
             BinaryBvh::kMaxDepth);
      }
      if (node.is_leaf()) {
        check_leaf(visit.node, node);
        continue;
      }
      check_inner(visit.node, node);
      stack[size++] = {node.first, visit.depth + 1};
      stack[size++] = {node.first + 1, visit.depth + 1};
    }
  }

  void check_inner(uint32_t index, const BinaryNode& node) {
    if (node.first <= index || node.first >= bvh_.nodes.size() - 1) {
      fail("inner node %u has its children at %u, expected after it and below %zu", index,
           node.first, bvh_.nodes.size() - 1);
    }
    Bounds both = Bounds::empty();
    for (uint32_t child = node.first; child < node.first + 2; ++child) {
      if (std::exchange(is_visited_[child], uint8_t{1})) fail("node %u has two parents", child);
      both.extend(bvh_.nodes[child].bounds);
    }
    if (!is_equal(node.bounds, both)) {
      fail("the box of inner node %u is not the union of its children's", index);
    }
  }

  void check_leaf(uint32_t index, const BinaryNode& node) {
    if (node.count > max_leaf_size_) {
      fail("leaf %u owns %u primitives, expected at most %u", index, node.count, max_leaf_size_);
    }
    if (node.first > count_ || node.count > count_ - node.first) {
      fail("leaf %u owns ids %u to %llu, expected below %zu", index, node.first,
           static_cast<unsigned long long>(node.first) + node.count, count_);
    }
    Bounds all = Bounds::empty();
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      all.extend(primitives_[claim(index, bvh_.primitive_ids[i])].bounds());
    }
    if (!is_equal(node.bounds, all)) {
      fail("the box of leaf %u is not the union of its primitives'", index);
    }
  }

  /// The primitive of an id, which from now on belongs to the leaf.
  uint32_t claim(uint32_t leaf, uint32_t id) {
    const uint32_t* found = std::lower_bound(
        by_id_.begin(), by_id_.end(), id,
        [this](uint32_t index, uint32_t wanted) { return primitives_[index].id < wanted; });
    if (found == by_id_.end() || primitives_[*found].id != id) {
      fail("leaf %u owns id %u, which is no primitive's", leaf, id);
    }
    if (std::exchange(is_owned_[static_cast<size_t>(found - by_id_.begin())], uint8_t{1})) {
      fail("leaf %u owns id %u, which another leaf owns too", leaf, id);
    }
    return *found;
  }

  const BinaryBvh& bvh_;
  const BuildPrimitive* primitives_;
  size_t count_;
  uint32_t max_leaf_size_;
  Array<uint32_t> by_id_;
  Array<uint8_t> is_owned_;
  Array<uint8_t> is_visited_;
};

}  // namespace

void verify_binary_bvh(const BinaryBvh& bvh, const BuildPrimitive* primitives, size_t count,
                       uint32_t max_leaf_size, Memory& memory) {
  BinaryVerifier(bvh, primitives, count, max_leaf_size, memory).run();
}

}  // namespace kiwami
