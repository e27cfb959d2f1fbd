// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/triangle_source.h"

namespace kiwami {

/// Checks every invariant of a binary tree over count primitives: each id in exactly one leaf (ids
/// and boxes taken from primitives, in any order), each inner box exactly the union of its
/// children's, each leaf box exactly the union of its primitives', children after parents, depth
/// and leaf sizes in range. Throws Error(VALIDATION) that names the node.
///
/// Of a tree that has_duplicates, source gives the triangles: each id may stand in several leaves,
/// in each once, whose boxes together cover the triangle; and no leaf box leaves the union of its
/// primitives'.
void verify_binary_bvh(const BinaryBvh& bvh, const BuildPrimitive* primitives, size_t count,
                       uint32_t max_leaf_size, Memory& memory,
                       const TriangleSource* source = nullptr);

}  // namespace kiwami
