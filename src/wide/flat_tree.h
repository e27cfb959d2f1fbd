// SPDX-License-Identifier: Apache-2.0
// A tree as arrays to look at: one node for each path, whatever the stored nodes share.
#pragma once

#include "core/memory.h"
#include "kiwami/bvh.h"
#include "wide/contraction.h"
#include "wide/wide_tree.h"

namespace kiwami {

struct FlatTree {
  Array<kiwami_bvh_node> nodes;   ///< breadth first
  Array<uint32_t> primitive_ids;  ///< depth first, so that those of each subtree are a run
};

/// The paths of a wide tree. Throws Error(TOO_LARGE) where node numbers would not fit.
FlatTree flatten(const WideTree& tree, Memory& memory);

/// A binary tree itself.
FlatTree flatten(const BinaryBvh& binary, Memory& memory);

/// A wide tree that is not packed, so that nothing is shared.
FlatTree flatten(const Contraction& contraction, const BinaryBvh& binary, Memory& memory);

/// The same.
FlatTree flatten(const WideDraft& draft, Memory& memory);

}  // namespace kiwami
