// SPDX-License-Identifier: Apache-2.0
// From primitives to the boxes that builders take.
#pragma once

#include <cstring>

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// Primitives that one task looks at.
constexpr size_t kCollectedBlock = 8192;

inline size_t blocks_of(size_t count) { return (count + kCollectedBlock - 1) / kCollectedBlock; }

/// Calls make_block(begin, end, made) for blocks of count primitives, each of which writes those
/// that can be hit, by rising id, and returns how many there are; returns all of them.
template <typename MakeBlock>
Array<BuildPrimitive> collect_blocks(size_t count, Memory& memory, const Parallel& parallel,
                                     MakeBlock&& make_block) {
  Array<BuildPrimitive> primitives(memory, count);
  Array<size_t> made_counts(memory, blocks_of(count));
  parallel.for_blocks(count, kCollectedBlock, [&](size_t begin, size_t end) {
    made_counts[begin / kCollectedBlock] = make_block(begin, end, primitives.data() + begin);
  });

  // Close the gaps that left-out primitives made; mostly there are none.
  size_t kept = 0;
  for (size_t block = 0; block < made_counts.size(); ++block) {
    const BuildPrimitive* made = primitives.data() + block * kCollectedBlock;
    if (made != primitives.data() + kept) {
      std::memmove(primitives.data() + kept, made, made_counts[block] * sizeof(BuildPrimitive));
    }
    kept += made_counts[block];
  }
  primitives.shrink(kept);
  return primitives;
}

}  // namespace kiwami
