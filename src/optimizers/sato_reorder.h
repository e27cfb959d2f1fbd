// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// Puts the children of each node in the order of falling surface area: what is large hides much,
/// so any-hit rays, which visit children in their order, end sooner. J.-H. Nah, D. Manocha, "SATO:
/// Surface Area Traversal Order for Shadow Ray Tracing", CGF 33(6), 2014, for nodes of several
/// children. The topology stays, and with it all answers.
void reorder_by_surface_area(WideTree& tree, Memory& memory, const Parallel& parallel);

}  // namespace kiwami
