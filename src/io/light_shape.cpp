// SPDX-License-Identifier: Apache-2.0
#include "io/light_shape.h"

#include <algorithm>

#include "core/error.h"

namespace kiwami::file {
namespace {

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

class ShapeChecker {
 public:
  ShapeChecker(std::span<const uint32_t> links, std::span<const uint32_t> slots, uint32_t width,
               const LightSet& set, Memory& memory)
      : links_(links), slots_(slots), width_(width), set_(set), memory_(memory) {}

  void check_links() const {
    const size_t light_count = set_.lights.size();
    Array<uint8_t> is_due(memory_, light_count + set_.instances.size());
    size_t due_count = 0;
    for (size_t leaf = 0; leaf < is_due.size(); ++leaf) {
      const bool is_in_tree =
          leaf < light_count
              ? set_.lights[leaf].kind == LightKind::kLocal
              : set_.instances[leaf - light_count].lights->summary().light_count != 0;
      is_due[leaf] = is_in_tree ? 1 : 0;
      due_count += is_due[leaf];
    }
    if (links_.size() != (due_count == 0 ? 0 : 2 * due_count - 1)) {
      fail("the tree over lights has %zu links, expected those of %zu leaves", links_.size(),
           due_count);
    }
    // By node, from the last one on: where its subtree ends.
    Array<uint32_t> ends(memory_, links_.size());
    for (size_t node = links_.size(); node-- != 0;) {
      const uint32_t link = links_[node];
      if (is_light_leaf(link)) {
        const uint32_t leaf = link & ~kLightLeafBit;
        if (leaf >= is_due.size() || is_due[leaf] == 0) {
          fail("cluster %zu is leaf %u, expected one that is in no other", node, leaf);
        }
        is_due[leaf] = 0;
        ends[node] = static_cast<uint32_t>(node) + 1;
        continue;
      }
      if (node + 1 >= links_.size() || link >= links_.size() || ends[node + 1] != link) {
        fail("cluster %zu has its right child at %u, expected it behind the left one", node, link);
      }
      ends[node] = ends[link];
    }
    if (!links_.empty() && ends[0] != links_.size()) {
      fail("the tree over lights ends at %u, expected %zu", ends[0], links_.size());
    }
  }

  /// Returns how many nodes are on the longest path.
  uint32_t check_slots() {
    const size_t node_slots = slots_of(width_), node_count = slots_.size() / node_slots;
    if (slots_.size() % node_slots != 0 || node_count > links_.size() ||
        (node_count == 0) != links_.empty()) {
      fail("the tree over lights has %zu slots, expected those of 1 to %zu nodes of %u",
           slots_.size(), links_.size(), slots_of(width_));
    }
    nodes_ = Array<Node>(memory_, node_count);
    if (node_count == 0) return 0;
    nodes_[found_++] = {0, 1};
    uint32_t depth = 0;
    for (size_t i = 0; i < node_count; ++i) {
      if (i == found_) fail("the tree over lights has %zu nodes, expected %zu", node_count, i);
      depth = std::max(depth, nodes_[i].depth);
      divide(nodes_[i], slots_.subspan(i * node_slots, node_slots));
    }
    if (found_ != node_count) {
      fail("the tree over lights has %zu nodes, expected %zu", node_count, found_);
    }
    return depth;
  }

 private:
  struct Node {
    uint32_t cluster;
    uint32_t depth;
  };

  /// Opens the clusters of a node, from the first on, until they are those of its slots.
  void divide(const Node& node, std::span<const uint32_t> slots) {
    uint32_t stack[16];
    uint32_t size = 0, next = 0;
    stack[size++] = node.cluster;
    while (size != 0) {
      const uint32_t cluster = stack[--size];
      const bool is_leaf = is_light_leaf(links_[cluster]);
      if (next < width_ && slots[next] == cluster && (is_leaf || cluster != node.cluster)) {
        ++next;
        if (!is_leaf) add({cluster, node.depth + 1});
        continue;
      }
      if (is_leaf || size + 2 + next > width_) {
        fail("the slots of a node do not divide cluster %u, expected %u clusters at most that do",
             node.cluster, width_);
      }
      stack[size++] = links_[cluster];
      stack[size++] = cluster + 1;
    }
    for (; next < slots.size(); ++next) {
      if (slots[next] != kNoLightSlot) fail("a slot holds cluster %u, expected none", slots[next]);
    }
  }

  void add(const Node& node) {
    if (found_ == nodes_.size() || node.depth > kMaxLightDepth) {
      fail("the tree over lights has more than %zu nodes, or paths of more than %u", nodes_.size(),
           kMaxLightDepth);
    }
    nodes_[found_++] = node;
  }

  std::span<const uint32_t> links_, slots_;
  uint32_t width_;
  const LightSet& set_;
  Memory& memory_;
  Array<Node> nodes_;  ///< breadth first
  size_t found_ = 0;
};

Array<uint32_t> borrowed(std::span<const uint32_t> elements) {
  return Array<uint32_t>::borrow(const_cast<uint32_t*>(elements.data()), elements.size());
}

}  // namespace

SavedLightShape checked_light_shape(std::span<const uint32_t> links,
                                    std::span<const uint32_t> slots, uint32_t width,
                                    const LightSet& set, Memory& memory) {
  ShapeChecker checker(links, slots, width, set, memory);
  checker.check_links();
  SavedLightShape shape;
  shape.tree.depth = checker.check_slots();
  shape.tree.width = width;
  shape.tree.node_count = static_cast<uint32_t>(slots.size() / slots_of(width));
  shape.tree.slot_clusters = borrowed(slots);
  shape.links = borrowed(links);
  shape.leaf_count = static_cast<uint32_t>(set.lights.size() + set.instances.size());
  return shape;
}

}  // namespace kiwami::file
