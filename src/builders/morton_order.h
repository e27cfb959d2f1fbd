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

MortonOrder sort_by_morton_code(Array<BuildPrimitive> primitives, Memory& memory,
                                const Parallel& parallel);

}  // namespace kiwami
