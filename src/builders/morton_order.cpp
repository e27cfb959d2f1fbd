// SPDX-License-Identifier: Apache-2.0
#include "builders/morton_order.h"

#include <algorithm>
#include <bit>

#include "builders/sah_bins.h"
#include "math/extended_morton.h"
#include "math/morton.h"
#include "parallel/radix_sort.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 8192;

/// Unions of boxes are exact, so blocks do not show in them.
RangeBounds bounds_of(const Array<BuildPrimitive>& primitives, Memory& memory,
                      const Parallel& parallel) {
  Array<RangeBounds> of_blocks(memory, (primitives.size() + kBlockSize - 1) / kBlockSize);
  parallel.for_blocks(primitives.size(), kBlockSize, [&](size_t begin, size_t end) {
    RangeBounds bounds = RangeBounds::empty();
    for (size_t i = begin; i < end; ++i) bounds.extend(primitives[i]);
    of_blocks[begin / kBlockSize] = bounds;
  });
  RangeBounds all = RangeBounds::empty();
  for (const RangeBounds& bounds : of_blocks) all.extend(bounds);
  return all;
}

/// Sorts by code_of(primitive), a number of 63 bits.
template <typename CodeOf>
Array<CodedIndex> sort_by_code(const Array<BuildPrimitive>& primitives, Memory& memory,
                               const Parallel& parallel, CodeOf&& code_of) {
  Array<CodedIndex> coded(memory, primitives.size());
  parallel.for_blocks(primitives.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      coded[i] = {code_of(primitives[i]), static_cast<uint32_t>(i)};
    }
  });
  radix_sort(
      coded, 63, [](const CodedIndex& element) { return element.code; }, memory, parallel);
  return coded;
}

}  // namespace

MortonCodes sort_morton_codes(const Array<BuildPrimitive>& primitives, Memory& memory,
                              const Parallel& parallel, CurveCode code) {
  const RangeBounds bounds = bounds_of(primitives, memory, parallel);
  const Bounds centroids = bounds.centroids.bounds(), objects = bounds.geometry.bounds();
  if (code == CurveCode::kPlain) {
    const MortonGrid grid(centroids);
    return {sort_by_code(primitives, memory, parallel,
                         [&](const BuildPrimitive& primitive) {
                           return grid.code(primitive.doubled_centroid());
                         }),
            objects};
  }
  const ExtendedMortonGrid grid(centroids, objects);
  return {
      sort_by_code(primitives, memory, parallel,
                   [&](const BuildPrimitive& primitive) { return grid.code(primitive.bounds()); }),
      objects};
}

MortonOrder sort_by_morton_code(Array<BuildPrimitive> primitives, Memory& memory,
                                const Parallel& parallel, CurveCode code) {
  const size_t count = primitives.size();
  const Array<CodedIndex> sorted = sort_morton_codes(primitives, memory, parallel, code).sorted;
  MortonOrder order{Array<uint64_t>(memory, count), Array<BuildPrimitive>(memory, count)};
  parallel.for_blocks(count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      order.codes[i] = sorted[i].code;
      order.primitives[i] = primitives[sorted[i].index];
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
