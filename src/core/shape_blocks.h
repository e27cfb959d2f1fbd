// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/shape_source.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// The shapes of each leaf block of a tree, in the order of the blocks: see ShapeSource::blocks.
Array<float> make_shape_blocks(const ShapeSource& source, const WideTree& tree, Memory& memory,
                               const Parallel& parallel);

}  // namespace kiwami
