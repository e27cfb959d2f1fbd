// SPDX-License-Identifier: Apache-2.0
// Primitives along a space-filling curve: where the builders from below begin.
#pragma once

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

/// Where the cell of the codes from begin to end is halved: at the first code in which the highest
/// bit that differs is set. Equal codes are halved by their number.
uint32_t middle_of_cell(const Array<uint64_t>& codes, uint32_t begin, uint32_t end);

}  // namespace kiwami
