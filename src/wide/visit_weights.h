// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bvh/binary_bvh.h"
#include "bvh/representative_rays.h"
#include "parallel/parallel.h"

namespace kiwami {

/// So many rays count as much as the guess from areas that they correct.
constexpr float kVisitGuessWeight = 16.0f;

/// For each node of a binary tree how likely a ray that looks for its closest hit visits it, 1 for
/// the root, from rays: a ray visits the boxes that it meets up to its hit. Where few rays come,
/// the ratio of the areas of a node and its parent, which is what evenly spread lines would give,
/// stands in: it counts as much as guess_weight rays. No more likely than the parent. The tree is
/// not empty. The same for any number of threads.
Array<float> measure_visit_weights(const BinaryBvh& bvh, const TriangleSource& source,
                                   std::span<const RepresentativeRay> rays, float guess_weight,
                                   Memory& memory, const Parallel& parallel);

}  // namespace kiwami
