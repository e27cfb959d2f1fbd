// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "builders/binned_sah_builder.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_draft.h"

namespace kiwami {

struct WideTopDownConfig {
  uint32_t width = 8;       ///< children a node: 4, 8 or 16
  uint32_t leaf_width = 8;  ///< primitives a leaf, at most the width
  bool fill_nodes = false;  ///< as in optimal_contraction.h
  /// The splits. Leaves of at most max_leaf_size primitives are where splitting ends; those of the
  /// wide tree own up to leaf_width. Costs are those of wide nodes and leaves.
  BinnedSahBuilder::Config splits;
};

/// A wide tree from the root down, of which no binary tree is kept. Primitives are divided as by
/// BinnedSahBuilder, near the root by all threads at once. Whoever divides a subtree knows its
/// splits until that is done: then it solves the dynamic programme of optimal_contraction.h over
/// them, writes the wide nodes of least cost below its largest nodes and forgets the splits. The
/// largest nodes of all subtrees and those near the root follow in the same way. The same tree for
/// any number of threads.
WideDraft build_wide_top_down(Array<BuildPrimitive> primitives, const WideTopDownConfig& config,
                              Memory& memory, const Parallel& parallel);

}  // namespace kiwami
