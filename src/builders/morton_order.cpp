// SPDX-License-Identifier: Apache-2.0
#include "builders/morton_order.h"

#include <algorithm>
#include <bit>

#include "math/morton.h"
#include "parallel/radix_sort.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 8192;

struct CodedIndex {
  uint64_t code;
  uint32_t index;
};

/// The box of the doubled centroids; unions of boxes are exact, so blocks do not show in it.
Bounds centroid_bounds(const Array<BuildPrimitive>& primitives, Memory& memory,
                       const Parallel& parallel) {
  Array<Bounds> of_blocks(memory, (primitives.size() + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(primitives.size(), kBlockSize, [&](size_t begin, size_t end) {
    Bounds bounds = Bounds::empty();
    for (size_t i = begin; i < end; ++i) bounds.extend(primitives[i].doubled_centroid());
    of_blocks[begin / kBlockSize] = bounds;
  });
  Bounds all = Bounds::empty();
  for (const Bounds& bounds : of_blocks) all.extend(bounds);
  return all;
}

}  // namespace

MortonOrder sort_by_morton_code(Array<BuildPrimitive> primitives, Memory& memory,
                                const Parallel& parallel) {
  const size_t count = primitives.size();
  const MortonGrid grid(centroid_bounds(primitives, memory, parallel));
  Array<CodedIndex> coded(memory, count);
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      coded[i] = {grid.code(primitives[i].doubled_centroid()), static_cast<uint32_t>(i)};
    }
  });
  radix_sort(
      coded, 3 * kMortonBits, [](const CodedIndex& element) { return element.code; }, memory,
      parallel);
  MortonOrder order{Array<uint64_t>(memory, count), Array<BuildPrimitive>(memory, count)};
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      order.codes[i] = coded[i].code;
      order.primitives[i] = primitives[coded[i].index];
    }
  });
  return order;
}

uint32_t middle_of_cell(const Array<uint64_t>& codes, uint32_t begin, uint32_t end) {
  const uint64_t last = codes[end - 1], differing = codes[begin] ^ last;
  if (differing == 0) return begin + (end - begin + 1) / 2;
  const uint64_t boundary = last & ~(std::bit_floor(differing) - 1);
  return static_cast<uint32_t>(
      std::lower_bound(codes.begin() + begin, codes.begin() + end, boundary) - codes.begin());
}

}  // namespace kiwami
