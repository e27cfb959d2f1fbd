// SPDX-License-Identifier: Apache-2.0
// Primitives along a space-filling curve: where the builders from below begin.
#pragma once

#include <algorithm>
#include <bit>

#include "bvh/binary_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

struct MortonOrder {
  Array<uint64_t> codes;             ///< of 63 bits, rising
  Array<BuildPrimitive> primitives;  ///< in their order; equal codes by the order given
};

/// A primitive's code and its number in the order given.
struct CodedIndex {
  uint64_t code;
  uint32_t index;
};

/// The same order for builders that leave the primitives where they are.
struct MortonCodes {
  Array<CodedIndex> sorted;
  Bounds bounds;  ///< of all primitives
};

/// Which codes.
enum class CurveCode {
  kPlain,    ///< the bits of the three axes in turn
  kExtended  ///< the longest axis first, with bits of the size (ExtendedMortonGrid)
};

MortonCodes sort_morton_codes(const Array<BuildPrimitive>& primitives, Memory& memory,
                              const Parallel& parallel, CurveCode code = CurveCode::kPlain);

MortonOrder sort_by_morton_code(Array<BuildPrimitive> primitives, Memory& memory,
                                const Parallel& parallel, CurveCode code = CurveCode::kPlain);

/// Where the cell of the elements from begin to end, by rising code_of, is halved: at the first code
/// in which the highest bit that differs is set. Equal codes are halved by their number.
template <typename T, typename CodeOf>
uint32_t middle_of_cell(const Array<T>& elements, uint32_t begin, uint32_t end, CodeOf&& code_of) {
  const uint64_t last = code_of(elements[end - 1]), differing = code_of(elements[begin]) ^ last;
  if (differing == 0) return begin + (end - begin + 1) / 2;
  const uint64_t boundary = last & ~(std::bit_floor(differing) - 1);
  const auto is_below = [&](const T& element, uint64_t code) { return code_of(element) < code; };
  return static_cast<uint32_t>(
      std::lower_bound(elements.begin() + begin, elements.begin() + end, boundary, is_below) -
      elements.begin());
}

inline uint32_t middle_of_cell(const Array<uint64_t>& codes, uint32_t begin, uint32_t end) {
  return middle_of_cell(codes, begin, end, [](uint64_t code) { return code; });
}

inline uint32_t middle_of_cell(const Array<CodedIndex>& sorted, uint32_t begin, uint32_t end) {
  return middle_of_cell(sorted, begin, end, [](const CodedIndex& element) { return element.code; });
}

}  // namespace kiwami
