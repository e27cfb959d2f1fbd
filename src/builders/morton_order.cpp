// SPDX-License-Identifier: Apache-2.0
#include "builders/morton_order.h"

#include <algorithm>
#include <bit>

#include "math/extended_morton.h"
#include "math/morton.h"
#include "parallel/radix_sort.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 8192;

struct CodedIndex {
  uint64_t code;
  uint32_t index;
};

/// The box of what part_of(primitive) gives; unions are exact, so blocks do not show in it.
template <typename PartOf>
Bounds bounds_of(const Array<BuildPrimitive>& primitives, Memory& memory, const Parallel& parallel,
                 PartOf&& part_of) {
  Array<Bounds> of_blocks(memory, (primitives.size() + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(primitives.size(), kBlockSize, [&](size_t begin, size_t end) {
    Bounds bounds = Bounds::empty();
    for (size_t i = begin; i < end; ++i) bounds.extend(part_of(primitives[i]));
    of_blocks[begin / kBlockSize] = bounds;
  });
  Bounds all = Bounds::empty();
  for (const Bounds& bounds : of_blocks) all.extend(bounds);
  return all;
}

Bounds centroid_bounds(const Array<BuildPrimitive>& primitives, Memory& memory,
                       const Parallel& parallel) {
  return bounds_of(primitives, memory, parallel,
                   [](const BuildPrimitive& primitive) { return primitive.doubled_centroid(); });
}

/// Sorts by code_of(primitive), a number of 63 bits.
template <typename CodeOf>
MortonOrder sort_by_code(const Array<BuildPrimitive>& primitives, Memory& memory,
                         const Parallel& parallel, CodeOf&& code_of) {
  const size_t count = primitives.size();
  Array<CodedIndex> coded(memory, count);
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      coded[i] = {code_of(primitives[i]), static_cast<uint32_t>(i)};
    }
  });
  radix_sort(
      coded, 63, [](const CodedIndex& element) { return element.code; }, memory, parallel);
  MortonOrder order{Array<uint64_t>(memory, count), Array<BuildPrimitive>(memory, count)};
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      order.codes[i] = coded[i].code;
      order.primitives[i] = primitives[coded[i].index];
    }
  });
  return order;
}

}  // namespace

MortonOrder sort_by_morton_code(Array<BuildPrimitive> primitives, Memory& memory,
                                const Parallel& parallel, CurveCode code) {
  const Bounds centroids = centroid_bounds(primitives, memory, parallel);
  if (code == CurveCode::kPlain) {
    const MortonGrid grid(centroids);
    return sort_by_code(primitives, memory, parallel, [&](const BuildPrimitive& primitive) {
      return grid.code(primitive.doubled_centroid());
    });
  }
  const Bounds objects =
      bounds_of(primitives, memory, parallel,
                [](const BuildPrimitive& primitive) { return primitive.bounds(); });
  const ExtendedMortonGrid grid(centroids, objects);
  return sort_by_code(primitives, memory, parallel, [&](const BuildPrimitive& primitive) {
    return grid.code(primitive.bounds());
  });
}

uint32_t middle_of_cell(const Array<uint64_t>& codes, uint32_t begin, uint32_t end) {
  const uint64_t last = codes[end - 1], differing = codes[begin] ^ last;
  if (differing == 0) return begin + (end - begin + 1) / 2;
  const uint64_t boundary = last & ~(std::bit_floor(differing) - 1);
  return static_cast<uint32_t>(
      std::lower_bound(codes.begin() + begin, codes.begin() + end, boundary) - codes.begin());
}

}  // namespace kiwami
