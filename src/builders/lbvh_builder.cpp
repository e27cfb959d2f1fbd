// SPDX-License-Identifier: Apache-2.0
#include "builders/lbvh_builder.h"

#include <atomic>
#include <bit>

#include "builders/curve_leaves.h"
#include "bvh/tree_edit.h"

namespace kiwami {
namespace {

/// Leaves that one task starts from.
constexpr size_t kLeafBlock = 4096;

/// What the border between two neighbours is compared by: the delta, then what halves runs of equal
/// deltas. Where both are equal, the border further left is the lesser one.
struct Border {
  uint64_t delta;
  uint32_t place;

  bool operator<(const Border& other) const {
    return delta != other.delta ? delta < other.delta : place < other.place;
  }
};

/// Inner node i stands for the border between primitives i and i + 1 and has its children at slots
/// 2 i + 1 and 2 i + 2, so that every node knows its place before the tree is complete.
class LinearHierarchy {
 public:
  LinearHierarchy(const LeavesAlongCurve& along, LbvhBuilder::Delta delta, BinaryBvh& bvh,
                  Memory& memory)
      : along_(along),
        delta_(delta),
        bvh_(bvh),
        last_(static_cast<uint32_t>(along.leaves.size()) - 1),
        ends_(memory, 2 * size_t{last_}),
        arrivals_(memory, last_) {
    arrivals_.fill_zero();
  }

  /// Builds all that a leaf completes on its way up.
  void climb(uint32_t leaf) {
    uint32_t left = leaf, right = leaf;
    BinaryNode node = along_.leaves[leaf];
    while (left != 0 || right != last_) {
      const bool is_left = left == 0 || (right != last_ && border(right) < border(left - 1));
      const uint32_t parent = is_left ? right : left - 1;
      const uint32_t first = 2 * parent + 1;
      bvh_.nodes[first + (is_left ? 0 : 1)] = node;
      ends_[2 * parent + (is_left ? 0 : 1)] = is_left ? left : right;
      // What the first one wrote before this, the second one sees after it.
      if (std::atomic_ref(arrivals_[parent]).fetch_add(1, std::memory_order_acq_rel) == 0) return;
      left = ends_[2 * parent];
      right = ends_[2 * parent + 1];
      node = {bvh_.nodes[first].bounds, first, 0};
      node.bounds.extend(bvh_.nodes[first + 1].bounds);
    }
    bvh_.nodes[0] = node;
  }

 private:
  Border border(uint32_t i) const {
    const uint32_t place = i ^ (i + 1);
    if (delta_ == LbvhBuilder::Delta::kCode) return {along_.codes[i] ^ along_.codes[i + 1], place};
    Bounds both = along_.leaves[i].bounds;
    both.extend(along_.leaves[i + 1].bounds);
    // Floats that are not negative compare as their bits do.
    return {std::bit_cast<uint32_t>(both.half_area()), place};
  }

  const LeavesAlongCurve& along_;
  LbvhBuilder::Delta delta_;
  BinaryBvh& bvh_;
  uint32_t last_;
  Array<uint32_t> ends_;      ///< of the ranges of both children, by inner node
  Array<uint32_t> arrivals_;  ///< children that are complete, by inner node
};

}  // namespace

BinaryBvh LbvhBuilder::build(Array<BuildPrimitive> primitives, const Config& config, Memory& memory,
                             const Parallel& parallel) {
  if (primitives.empty()) return {};
  BinaryBvh bvh{{}, Array<uint32_t>(memory, primitives.size())};
  {
    MortonOrder order =
        sort_by_morton_code(std::move(primitives), memory, parallel, config.curve_code);
    parallel.for_blocks(order.codes.size(), kLeafBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) bvh.primitive_ids[i] = order.primitives[i].id;
    });
    const LeavesAlongCurve along =
        config.chunk_size > 1
            ? leaves_by_area(std::move(order), config.chunk_size, memory, parallel)
            : leaves_of_one(std::move(order), memory, parallel);
    bvh.nodes = Array<BinaryNode>(memory, 2 * along.leaves.size() - 1);
    LinearHierarchy hierarchy(along, config.delta, bvh, memory);
    parallel.for_blocks(along.leaves.size(), kLeafBlock, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) hierarchy.climb(static_cast<uint32_t>(i));
    });
  }
  relabel_depth_first(bvh, memory);
  limit_depth(bvh, memory);
  return bvh;
}

}  // namespace kiwami
