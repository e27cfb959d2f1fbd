// SPDX-License-Identifier: Apache-2.0
// Nodes of two children leave nothing to vectors: this is baseline code over the scalar vocabulary,
// in a namespace of its own beside those of the instruction sets.
#define KIWAMI_ISA baseline
#include "scalar/simd.h"
// The vocabulary comes first: the kernels are written over it.
#include "core/binary_trace.h"
#include "kernels/binary-tree-inl.h"

namespace kiwami {

void trace_boxes(const BinaryTreeView& tree, const RayBatch& batch, BinaryTreeCounters& counters) {
  baseline::trace_binary_batch<true>(tree, batch, counters);
}

void trace_dual_split(const BinaryTreeView& tree, const RayBatch& batch,
                      BinaryTreeCounters& counters) {
  baseline::trace_binary_batch<false>(tree, batch, counters);
}

}  // namespace kiwami
