// SPDX-License-Identifier: Apache-2.0
// Leaves along a Morton curve: one primitive each, or chunks of neighbours.
#pragma once

#include "builders/morton_order.h"

namespace kiwami {

struct LeavesAlongCurve {
  Array<BinaryNode> leaves;  ///< of the primitives from first on, in the order of the curve
  Array<uint64_t> codes;     ///< of the first primitive of each
};

/// One leaf a primitive.
LeavesAlongCurve leaves_of_one(MortonOrder order, Memory& memory, const Parallel& parallel);

/// Leaves of up to chunk_size primitives (16 at most), so that the sum of their areas is the least
/// that neighbours along the curve allow: what rays pay for the tests of leaf blocks. Found by
/// dynamic programming within blocks of fixed borders, so threads do not show in it.
LeavesAlongCurve leaves_by_area(MortonOrder order, uint32_t chunk_size, Memory& memory,
                                const Parallel& parallel);

}  // namespace kiwami
