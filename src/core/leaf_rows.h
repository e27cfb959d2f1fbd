// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// Copies numbers of what stands in the leaves of a tree of ids next to each other: for each leaf
/// block row_count rows, at most kMostRows, of a float a lane. read(id, rows) fills the rows of one
/// lane; those of lanes without an id below id_count are 0 (of a file, lanes that no node refers to
/// may have any id).
template <uint32_t kMostRows, typename Read>
Array<float> make_leaf_rows(const WideTree& tree, size_t row_count, uint32_t id_count,
                            Memory& memory, const Parallel& parallel, const Read& read) {
  constexpr size_t kBlocksAtOnce = 1024;
  const size_t width = tree.leaf_width;
  Array<float> blocks(memory, tree.leaf_block_count * row_count * width);
  parallel.for_blocks(tree.leaf_block_count, kBlocksAtOnce, [&](size_t begin, size_t end) {
    for (size_t number = begin; number < end; ++number) {
      const uint32_t* const ids = tree.leaf_ids(number);
      float* const block = blocks.data() + number * row_count * width;
      for (size_t lane = 0; lane < width; ++lane) {
        float rows[kMostRows] = {};
        if (ids[lane] < id_count) read(ids[lane], rows);
        for (size_t row = 0; row < row_count; ++row) block[row * width + lane] = rows[row];
      }
    }
  });
  return blocks;
}

}  // namespace kiwami
