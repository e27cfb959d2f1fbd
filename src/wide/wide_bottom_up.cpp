// SPDX-License-Identifier: Apache-2.0
#include "wide/wide_bottom_up.h"

#include <bit>

#include "builders/morton_order.h"
#include "core/error.h"
#include "wide/cluster_forest.h"
#include "wide/forest_writer.h"

namespace kiwami {
namespace {

/// Blocks that one task builds.
constexpr size_t kBlocksPerTask = 4;
/// The end of a block may move by this part of its size.
constexpr uint32_t kReachOfEnds = 3;
/// A block of 2^11 clusters can always be built in so many levels of nodes, by halves.
constexpr uint32_t kHeightPerLevel = 11;

/// Clusters that are joined together.
struct Block {
  uint32_t begin, end;

  uint32_t size() const { return end - begin; }
};

template <int N>
class BottomUpBuild {
 public:
  BottomUpBuild(Array<BuildPrimitive> primitives, const WideBottomUpConfig& config, Memory& memory,
                const Parallel& parallel)
      : config_(config),
        memory_(memory),
        parallel_(parallel),
        primitives_(std::move(primitives)),
        primitive_ids_(memory, primitives_.size()),
        parts_(memory, parallel) {}

  WideDraft run() {
    {
      MortonCodes codes = sort_morton_codes(primitives_, memory_, parallel_, config_.curve_code);
      order_ = std::move(codes.sorted);
      bounds_ = codes.bounds;
    }
    Array<Block> blocks = cut(static_cast<uint32_t>(primitives_.size()));
    move_to_cells(blocks);
    build_level(blocks);
    order_ = Array<CodedIndex>();
    primitives_ = Array<BuildPrimitive>();
    while (blocks.size() > 1) {
      blocks = cut(static_cast<uint32_t>(parts_.clusters().size()));
      build_level(blocks);
    }
    return parts_.join(std::move(primitive_ids_));
  }

 private:
  using Writer = ForestWriter<N, ClusterForest<N>>;

  /// Blocks of nearly the same size.
  Array<Block> cut(uint32_t count) const {
    const uint32_t blocks = (count - 1) / config_.block_size + 1;
    Array<Block> cut(memory_, blocks);
    for (uint32_t i = 0; i < blocks; ++i) {
      cut[i].begin = static_cast<uint32_t>(uint64_t{count} * i / blocks);
      cut[i].end = static_cast<uint32_t>(uint64_t{count} * (i + 1) / blocks);
    }
    return cut;
  }

  /// Lets the first level's blocks end where the cells of the curve do that are largest: there,
  /// what stands on both sides would not be joined anyway.
  void move_to_cells(Array<Block>& blocks) const {
    const uint32_t reach = blocks[0].size() / kReachOfEnds;
    parallel_.for_blocks(blocks.size() - 1, kBlocksPerTask, [&](size_t begin, size_t end) {
      for (size_t i = begin; i < end; ++i) blocks[i].end = end_of_cell(blocks[i].end, reach);
    });
    for (size_t i = 1; i < blocks.size(); ++i) blocks[i].begin = blocks[i - 1].end;
  }

  uint32_t end_of_cell(uint32_t middle, uint32_t reach) const {
    uint32_t best = middle;
    uint64_t greatest = 0;
    for (uint32_t i = middle - reach; i < middle + reach; ++i) {
      const uint64_t difference = std::bit_floor(order_[i - 1].code ^ order_[i].code);
      if (difference > greatest) {
        greatest = difference;
        best = i;
      }
    }
    return best;
  }

  uint32_t target_of(const Block& block, const Array<Block>& blocks) const {
    return blocks.size() == 1 ? 1 : std::max(1u, block.size() / config_.reduction);
  }

  /// How high the subtrees of this level may be, so that those above still fit.
  uint32_t max_height(size_t block_count) const {
    uint32_t above = 0;
    for (size_t blocks = block_count; blocks > 1; blocks = (blocks - 1) / 16 + 1) ++above;
    return kMaxWideDepth - kHeightPerLevel * above;
  }

  /// Builds the blocks of one level; what they end with is the next one's beginning.
  void build_level(const Array<Block>& blocks) {
    uint32_t most_ends = 1;
    for (const Block& block : blocks) most_ends = std::max(most_ends, target_of(block, blocks));
    const WideCluster* below = clusters_below();
    const uint32_t first_part = parts_.start_level(blocks.size());
    Array<WideCluster> ends(memory_, blocks.size() * most_ends);
    Array<uint32_t> end_counts(memory_, blocks.size());
    parallel_.for_blocks(blocks.size(), kBlocksPerTask, [&](size_t begin, size_t end) {
      uint32_t capacity = 0;
      for (size_t i = begin; i < end; ++i) capacity = std::max(capacity, blocks[i].size());
      ClusterForest<N> forest(config_, bounds_.half_area(), capacity, memory_);
      Writer writer(forest, below, config_.fill_nodes, capacity, memory_);
      for (size_t i = begin; i < end; ++i) {
        fill_forest(blocks[i], forest);
        forest.join_nearest(target_of(blocks[i], blocks));
        const uint32_t part = first_part + static_cast<uint32_t>(i);
        WideCluster* block_ends = ends.data() + i * most_ends;
        if (write(blocks[i], forest, writer, part, block_ends) > max_height(blocks.size())) {
          forest.join_evenly(target_of(blocks[i], blocks));
          write(blocks[i], forest, writer, part, block_ends);
        }
        end_counts[i] = forest.place_count();
        parts_.set(part, writer.take(memory_));
      }
    });
    parts_.end_level(collect_ends(ends, end_counts, most_ends));
  }

  /// Those that a level begins with; nullptr: the first level, which begins with primitives.
  const WideCluster* clusters_below() const {
    return parts_.level_count() != 0 ? parts_.clusters().data() : nullptr;
  }

  void fill_forest(const Block& block, ClusterForest<N>& forest) const {
    const WideCluster* below = clusters_below();
    forest.clear(block.begin);
    for (uint32_t i = block.begin; i < block.end; ++i) {
      if (below) {
        forest.add_subtree(below[i].box, below[i].cost);
      } else {
        forest.add_primitive(primitives_[order_[i].index]);
      }
    }
  }

  /// Writes all trees of a forest; returns the greatest height.
  uint32_t write(const Block& block, const ClusterForest<N>& forest, Writer& writer, uint32_t part,
                 WideCluster* ends) {
    writer.start(primitive_ids_.data() + block.begin);
    uint32_t height = 0;
    for (uint32_t i = 0; i < forest.place_count(); ++i) {
      ends[i] = writer.write(forest.tree_at(i), part);
      height = std::max(height, ends[i].height);
    }
    return height;
  }

  Array<WideCluster> collect_ends(const Array<WideCluster>& ends, const Array<uint32_t>& counts,
                                  uint32_t most_ends) const {
    size_t total = 0;
    for (const uint32_t count : counts) total += count;
    Array<WideCluster> collected(memory_, total);
    WideCluster* to = collected.begin();
    for (size_t i = 0; i < counts.size(); ++i) {
      to = std::copy_n(ends.begin() + i * most_ends, counts[i], to);
    }
    return collected;
  }

  const WideBottomUpConfig& config_;
  Memory& memory_;
  const Parallel& parallel_;
  Array<BuildPrimitive> primitives_;
  Array<CodedIndex> order_;
  Bounds bounds_ = Bounds::empty();
  Array<uint32_t> primitive_ids_;
  WideParts parts_;
};

}  // namespace

WideDraft build_wide_bottom_up(Array<BuildPrimitive> primitives, const WideBottomUpConfig& config,
                               Memory& memory, const Parallel& parallel) {
  if (primitives.empty()) return {};
  switch (config.width) {
    case 4:
      return BottomUpBuild<4>(std::move(primitives), config, memory, parallel).run();
    case 8:
      return BottomUpBuild<8>(std::move(primitives), config, memory, parallel).run();
    case 16:
      return BottomUpBuild<16>(std::move(primitives), config, memory, parallel).run();
    default:
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "width is %u, expected 4, 8 or 16", config.width);
  }
}

}  // namespace kiwami
