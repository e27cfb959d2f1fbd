// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "kernels/kernel_table.h"
#include "wide/binary_layout.h"

namespace kiwami {

/// Closest hits of a batch through a tree with boxes, or a dual-split tree, one ray after the other.
/// What is visited is added to the counters.
void trace_boxes(const BinaryTreeView& tree, const RayBatch& batch, BinaryTreeCounters& counters);
void trace_dual_split(const BinaryTreeView& tree, const RayBatch& batch,
                      BinaryTreeCounters& counters);

}  // namespace kiwami
