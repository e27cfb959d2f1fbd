// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/implicit_bvh.h"
#include "core/memory.h"
#include "parallel/parallel.h"

namespace kiwami {

/// The complete binary tree over primitives along a Morton curve, after F. M. Chitalu, C. Dubach,
/// T. Komura, "Binary Ostensibly-Implicit Trees for Fast Collision Detection", CGF 39(2)
/// (Eurographics), 2020: built level by level in an ImplicitBvh, then given pointers for the stages
/// that follow. Nothing looks at the boxes: the tree is as deep as the logarithm of the primitives
/// and no deeper, and costs what the curve gives.
class OibvhBuilder {
 public:
  /// One primitive a leaf. The same tree for any number of threads.
  static BinaryBvh build(Array<BuildPrimitive> primitives, Memory& memory,
                         const Parallel& parallel);
};

}  // namespace kiwami
