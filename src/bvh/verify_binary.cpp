// SPDX-License-Identifier: Apache-2.0
#include "bvh/verify_binary.h"

#include <algorithm>
#include <utility>

#include "bvh/triangle_cover.h"
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
                 uint32_t max_leaf_size, const TriangleSource* source, Memory& memory)
      : bvh_(bvh),
        primitives_(primitives),
        count_(count),
        max_leaf_size_(max_leaf_size),
        source_(source),
        memory_(memory),
        by_id_(memory, count),
        is_owned_(memory, count),
        is_visited_(memory, bvh.nodes.size()),
        parts_(memory) {
    is_owned_.fill_zero();
    is_visited_.fill_zero();
  }

  void run() {
    const size_t id_count = bvh_.primitive_ids.size();
    if (bvh_.has_duplicates ? id_count < count_ : id_count != count_) {
      fail("the tree has %zu primitive ids, expected %zu", id_count, count_);
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
    check_parts();
  }

 private:
  struct Visit {
    uint32_t node, depth;
  };

  /// A leaf around a part of a primitive.
  struct Part {
    size_t place;  ///< of the primitive, by id
    uint32_t leaf;
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
    const size_t id_count = bvh_.primitive_ids.size();
    if (node.first > id_count || node.count > id_count - node.first) {
      fail("leaf %u owns ids %u to %llu, expected below %zu", index, node.first,
           static_cast<unsigned long long>(node.first) + node.count, id_count);
    }
    Bounds all = Bounds::empty();
    for (uint32_t i = node.first; i < node.first + node.count; ++i) {
      const uint32_t id = bvh_.primitive_ids[i];
      const size_t place = claim(index, id);
      const Bounds box = primitives_[by_id_[place]].bounds();
      all.extend(box);
      if (!bvh_.has_duplicates) continue;
      const uint32_t* const ids = bvh_.primitive_ids.begin();
      if (std::find(ids + node.first, ids + i, id) != ids + i) {
        fail("leaf %u owns id %u twice", index, id);
      }
      if (node.bounds.contains(box)) {
        is_owned_[place] = kWhole;
      } else {
        parts_.push_back({place, index});
      }
    }
    const bool is_right = bvh_.has_duplicates ? all.contains(node.bounds) && !node.bounds.is_empty()
                                              : is_equal(node.bounds, all);
    if (!is_right) fail("the box of leaf %u is not the union of its primitives'", index);
  }

  /// Of each primitive that no leaf box holds, the boxes around its parts must cover the triangle.
  void check_parts() {
    Array<Part> parts = parts_.take();
    std::sort(parts.begin(), parts.end(), [](const Part& a, const Part& b) {
      return a.place < b.place || (a.place == b.place && a.leaf < b.leaf);
    });
    for (const Part *begin = parts.begin(), *end = begin; begin != parts.end(); begin = end) {
      while (end != parts.end() && end->place == begin->place) ++end;
      if (is_owned_[begin->place] == kWhole) continue;
      Array<Bounds> boxes(memory_, static_cast<size_t>(end - begin));
      for (size_t i = 0; i < boxes.size(); ++i) boxes[i] = bvh_.nodes[begin[i].leaf].bounds;
      Vec3f corner[3];
      const uint32_t id = primitives_[by_id_[begin->place]].id;
      source_->corners_of(id, corner);
      if (!is_covered(corner, {0, 0, 0}, {boxes.data(), boxes.size()})) {
        fail("the boxes of leaves do not cover primitive id %u, which leaf %u owns", id,
             begin->leaf);
      }
    }
  }

  /// The place of an id in by_id_; its primitive from now on belongs to the leaf.
  size_t claim(uint32_t leaf, uint32_t id) {
    const uint32_t* found = std::lower_bound(
        by_id_.begin(), by_id_.end(), id,
        [this](uint32_t index, uint32_t wanted) { return primitives_[index].id < wanted; });
    if (found == by_id_.end() || primitives_[*found].id != id) {
      fail("leaf %u owns id %u, which is no primitive's", leaf, id);
    }
    const size_t place = static_cast<size_t>(found - by_id_.begin());
    if (is_owned_[place] && !bvh_.has_duplicates) {
      fail("leaf %u owns id %u, which another leaf owns too", leaf, id);
    }
    if (!is_owned_[place]) is_owned_[place] = kInParts;
    return place;
  }

  const BinaryBvh& bvh_;
  const BuildPrimitive* primitives_;
  size_t count_;
  uint32_t max_leaf_size_;
  const TriangleSource* source_;
  Memory& memory_;
  Array<uint32_t> by_id_;
  /// Of is_owned_, for a primitive that some leaf owns.
  static constexpr uint8_t kInParts = 1, kWhole = 2;

  Array<uint8_t> is_owned_;
  Array<uint8_t> is_visited_;
  GrowingArray<Part> parts_;
};

}  // namespace

void verify_binary_bvh(const BinaryBvh& bvh, const BuildPrimitive* primitives, size_t count,
                       uint32_t max_leaf_size, Memory& memory, const TriangleSource* source) {
  BinaryVerifier(bvh, primitives, count, max_leaf_size, source, memory).run();
}

}  // namespace kiwami
