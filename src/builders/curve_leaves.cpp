// SPDX-License-Identifier: Apache-2.0
#include "builders/curve_leaves.h"

#include <algorithm>

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 4096;

/// Chunks of one block: how many primitives the chunk that ends at each place has, in the best
/// partition up to there.
class BlockPartition {
 public:
  BlockPartition(const BuildPrimitive* primitives, uint32_t count, uint32_t most)
      : primitives_(primitives), count_(count) {
    double cost[kBlockSize + 1];
    cost[0] = 0.0;
    for (uint32_t end = 1; end <= count; ++end) {
      Bounds bounds = Bounds::empty();
      double least = std::numeric_limits<double>::infinity();
      for (uint32_t size = 1; size <= std::min(most, end); ++size) {
        bounds.extend(primitives[end - size].bounds());
        const double with = cost[end - size] + static_cast<double>(bounds.half_area());
        // Of equal costs the larger chunk.
        if (with > least) continue;
        least = with;
        size_of_last_[end] = static_cast<uint8_t>(size);
      }
      cost[end] = least;
    }
    for (uint32_t end = count; end > 0; end -= size_of_last_[end]) ++chunk_count_;
  }

  uint32_t chunk_count() const { return chunk_count_; }

  /// Writes the leaves from right to left; the first primitive is number `first` of all.
  void write(uint32_t first, BinaryNode* leaves) const {
    uint32_t chunk = chunk_count_;
    for (uint32_t end = count_; end > 0; end -= size_of_last_[end]) {
      const uint32_t size = size_of_last_[end];
      Bounds bounds = Bounds::empty();
      for (uint32_t i = end - size; i < end; ++i) bounds.extend(primitives_[i].bounds());
      leaves[--chunk] = {bounds, first + end - size, size};
    }
  }

 private:
  const BuildPrimitive* primitives_;
  uint32_t count_;
  uint32_t chunk_count_ = 0;
  uint8_t size_of_last_[kBlockSize + 1];
};

}  // namespace

LeavesAlongCurve leaves_of_one(MortonOrder order, Memory& memory, const Parallel& parallel) {
  Array<BinaryNode> leaves(memory, order.codes.size());
  parallel.for_blocks(leaves.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      leaves[i] = {order.primitives[i].bounds(), static_cast<uint32_t>(i), 1};
    }
  });
  return {std::move(leaves), std::move(order.codes)};
}

LeavesAlongCurve leaves_by_area(MortonOrder order, uint32_t chunk_size, Memory& memory,
                                const Parallel& parallel) {
  // Each block's leaves at its place first, then side by side.
  const size_t count = order.codes.size();
  Array<BinaryNode> apart(memory, count);
  Array<uint32_t> first_of_blocks(memory, (count + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    const BlockPartition partition(&order.primitives[begin], static_cast<uint32_t>(end - begin),
                                   chunk_size);
    partition.write(static_cast<uint32_t>(begin), &apart[begin]);
    first_of_blocks[begin / kBlockSize] = partition.chunk_count();
  });
  order.primitives = {};
  uint32_t total = 0;
  for (uint32_t& first : first_of_blocks) total += std::exchange(first, total);
  LeavesAlongCurve along{Array<BinaryNode>(memory, total), Array<uint64_t>(memory, total)};
  parallel.for_each(first_of_blocks.size(), [&](size_t block) {
    const uint32_t first = first_of_blocks[block];
    const uint32_t last = block + 1 < first_of_blocks.size() ? first_of_blocks[block + 1] : total;
    for (uint32_t i = first; i < last; ++i) {
      along.leaves[i] = apart[block * kBlockSize + i - first];
      along.codes[i] = order.codes[along.leaves[i].first];
    }
  });
  return along;
}

}  // namespace kiwami
