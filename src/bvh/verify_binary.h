// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"

namespace kiwami {

/// Checks every invariant of a binary tree over count primitives: each id in exactly one leaf (ids
/// and boxes taken from primitives, in any order), each inner box exactly the union of its
/// children's, each leaf box exactly the union of its primitives', children after parents, depth
/// and leaf sizes in range. Throws Error(VALIDATION) that names the node.
void verify_binary_bvh(const BinaryBvh& bvh, const BuildPrimitive* primitives, size_t count,
                       uint32_t max_leaf_size, Memory& memory);

}  // namespace kiwami
