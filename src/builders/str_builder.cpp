// SPDX-License-Identifier: Apache-2.0
#include "builders/str_builder.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "bvh/tree_edit.h"
#include "parallel/radix_sort.h"

namespace kiwami {
namespace {

/// Pages that one task writes.
constexpr size_t kPageBlock = 512;

/// Twice the centre, as a number that compares as it does.
uint32_t key_of(const BinaryNode& entry, int axis) {
  const float centre = entry.bounds.lower[axis] + entry.bounds.upper[axis];
  const auto bits = std::bit_cast<uint32_t>(centre);
  return (bits & 0x80000000u) != 0 ? ~bits : bits | 0x80000000u;
}

/// The entries of one level, in the order of their pages. What they own tells equal centres apart.
class Tiling {
 public:
  Tiling(Array<BinaryNode>& entries, uint32_t page_size, Memory& memory, const Parallel& parallel)
      : entries_(entries), page_size_(page_size), memory_(memory), parallel_(parallel) {}

  void run() {
    radix_sort(
        entries_, 32, [](const BinaryNode& entry) { return key_of(entry, 0); }, memory_, parallel_);
    parallel_.for_blocks(entries_.size(), part_of(entries_.size(), 3),
                         [this](size_t begin, size_t end) { cut_slab(begin, end); });
  }

 private:
  /// The entries of one part, in whole pages, where `axes` axes are still to be cut: as many parts
  /// as there are pages along an edge of a cube of all pages.
  size_t part_of(size_t entries, int axes) const {
    const size_t whole_pages = (entries + page_size_ - 1) / page_size_;
    const auto pages = static_cast<double>(whole_pages);
    const double pages_of_part = axes == 3 ? std::pow(pages, 2.0 / 3.0) : std::sqrt(pages);
    return page_size_ * static_cast<size_t>(std::ceil(pages_of_part - 1e-9));
  }

  void sort(size_t begin, size_t end, int axis) {
    std::sort(entries_.begin() + begin, entries_.begin() + end,
              [axis](const BinaryNode& a, const BinaryNode& b) {
                const uint32_t key_a = key_of(a, axis), key_b = key_of(b, axis);
                return key_a != key_b ? key_a < key_b : a.first < b.first;
              });
  }

  void cut_slab(size_t begin, size_t end) {
    sort(begin, end, 1);
    const size_t run = part_of(end - begin, 2);
    for (size_t first = begin; first < end; first += run) {
      sort(first, std::min(first + run, end), 2);
    }
  }

  Array<BinaryNode>& entries_;
  size_t page_size_;
  Memory& memory_;
  const Parallel& parallel_;
};

/// A balanced subtree over entries, with its pairs of nodes from first_pair on.
BinaryNode halve(const BinaryNode* entries, uint32_t count, uint32_t first_pair, BinaryBvh& bvh) {
  if (count == 1) return *entries;
  const uint32_t left_count = (count + 1) / 2;
  const uint32_t first = 2 * first_pair + 1;
  bvh.nodes[first] = halve(entries, left_count, first_pair + 1, bvh);
  bvh.nodes[first + 1] =
      halve(entries + left_count, count - left_count, first_pair + left_count, bvh);
  Bounds bounds = bvh.nodes[first].bounds;
  bounds.extend(bvh.nodes[first + 1].bounds);
  return {bounds, first, 0};
}

}  // namespace

BinaryBvh StrBuilder::build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                            const Parallel& parallel) {
  if (primitives.empty()) return {};
  const size_t count = primitives.size();
  BinaryBvh bvh{{}, Array<uint32_t>(memory, count)};
  Array<BinaryNode> entries(memory, count);
  for (uint32_t i = 0; i < count; ++i) {
    bvh.primitive_ids[i] = primitives[i].id;
    entries[i] = {primitives[i].bounds(), i, 1};
  }
  primitives = {};
  const uint32_t page_size = config.page_size;
  uint32_t next_pair = 0;
  while (entries.size() > 1) {
    Tiling(entries, page_size, memory, parallel).run();
    if (bvh.nodes.empty()) bvh.nodes = Array<BinaryNode>(memory, 2 * count - 1);
    // A page of k entries takes k - 1 pairs.
    Array<BinaryNode> pages(memory, (entries.size() + page_size - 1) / page_size);
    parallel.for_blocks(pages.size(), kPageBlock, [&](size_t begin, size_t end) {
      for (size_t page = begin; page < end; ++page) {
        const size_t first = page * page_size;
        const auto size =
            static_cast<uint32_t>(std::min<size_t>(page_size, entries.size() - first));
        const auto pair = next_pair + static_cast<uint32_t>(page) * (page_size - 1);
        pages[page] = halve(&entries[first], size, pair, bvh);
      }
    });
    next_pair += static_cast<uint32_t>(entries.size() - pages.size());
    entries = std::move(pages);
  }
  if (bvh.nodes.empty()) bvh.nodes = Array<BinaryNode>(memory, 1);
  bvh.nodes[0] = entries[0];
  entries = {};
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami
