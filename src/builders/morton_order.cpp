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

constexpr uint32_t kCodeBits = 63;
/// Runs of elements up to this length are sorted by comparisons.
constexpr size_t kLongestRun = 4096;

/// The leading bits of codes that tell most of count elements apart, in whole digits.
uint32_t leading_bits(size_t count) {
  return std::min((static_cast<uint32_t>(std::bit_width(count)) + 12 + 7) / 8 * 8, kCodeBits);
}

/// Elements whose codes are equal above the lowest bits.
class Runs {
 public:
  Runs(Array<CodedIndex>& coded, uint32_t lowest, Memory& memory, const Parallel& parallel)
      : coded_(coded),
        lowest_(lowest),
        parallel_(parallel),
        block_count_((coded.size() + kBlockSize - 1) / kBlockSize),
        firsts_(memory, block_count_ + 1),
        longest_(memory, block_count_) {
    firsts_[block_count_] = coded.size();
    parallel.for_each(block_count_, [this](size_t block) { find(block); });
  }

  size_t longest() const { return *std::max_element(longest_.begin(), longest_.end()); }

  /// Sorts each by the whole code and then by index.
  void sort() {
    parallel_.for_each(block_count_, [this](size_t block) {
      size_t next = block + 1;
      while (firsts_[next] == coded_.size() && next < block_count_) ++next;
      for (size_t first = firsts_[block]; first < firsts_[next];) {
        const size_t end = end_of(first, firsts_[next]);
        if (end - first > 1) std::sort(&coded_[first], &coded_[first] + (end - first), is_before);
        first = end;
      }
    });
  }

 private:
  /// The first run that begins in a block, and the longest of these.
  void find(size_t block) {
    const size_t end = std::min(coded_.size(), (block + 1) * kBlockSize);
    size_t first = block * kBlockSize;
    while (first != 0 && first < end && is_same_run(first - 1)) ++first;
    firsts_[block] = first < end ? first : coded_.size();
    size_t longest = 0;
    for (size_t last = first; first < end; first = last) {
      last = end_of(first, coded_.size());
      longest = std::max(longest, last - first);
    }
    longest_[block] = longest;
  }

  static bool is_before(const CodedIndex& a, const CodedIndex& b) {
    return a.code != b.code ? a.code < b.code : a.index < b.index;
  }
  bool is_same_run(size_t i) const { return (coded_[i].code ^ coded_[i + 1].code) >> lowest_ == 0; }
  /// No element from limit on is looked at.
  size_t end_of(size_t first, size_t limit) const {
    while (first + 1 < limit && is_same_run(first)) ++first;
    return first + 1;
  }

  Array<CodedIndex>& coded_;
  uint32_t lowest_;
  const Parallel& parallel_;
  size_t block_count_;
  Array<size_t> firsts_;   ///< by block: where its first run begins; all: it has none
  Array<size_t> longest_;  ///< by block
};

/// Sorts by code; equal ones stay in the order given. Most elements are told apart by their leading
/// bits, so these are sorted by digits, and what is left run by run.
void sort_coded(Array<CodedIndex>& coded, Memory& memory, const Parallel& parallel) {
  const uint32_t leading = leading_bits(coded.size()), lowest = kCodeBits - leading;
  radix_sort(
      coded, leading, [=](const CodedIndex& element) { return element.code >> lowest; }, memory,
      parallel);
  if (lowest == 0 || coded.empty()) return;
  Runs runs(coded, lowest, memory, parallel);
  if (runs.longest() <= kLongestRun) {
    runs.sort();
  } else {
    radix_sort(
        coded, kCodeBits, [](const CodedIndex& element) { return element.code; }, memory, parallel);
  }
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
  sort_coded(coded, memory, parallel);
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

}  // namespace kiwami
