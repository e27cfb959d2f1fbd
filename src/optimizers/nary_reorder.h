// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bvh/representative_rays.h"
#include "core/memory.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

struct NaryReorderConfig {
  float node_cost = 1.0f;
  float leaf_cost = 1.0f;
  /// So many rays count as much as the guess from areas that they correct.
  float guess_weight = 8.0f;
};

/// Puts the children of each node in the order in which an any-hit ray, which visits them in their
/// order, is expected to end soonest: S. Ogaki, A. Derouet-Jourdan, "An N-ary BVH Child Node
/// Sorting Technique for Occlusion Tests", JCGT 5(2), 2016. Children stand by falling b / C: how
/// likely a ray that meets the child's box is stopped inside, per cost of a visit. The rays are
/// followed to all that they meet, so that what they find does not depend on the order before.
/// Departs from it in the guess that stands in where few rays came: how likely a ray of any kind
/// meets the triangles of a box, from their areas (after T. Ize, C. Hansen, "RTSAH Traversal Order
/// for Occlusion Rays", CGF 30(2), 2011). The topology stays, and with it all answers.
/// Of a tree over boxes (the source holds no meshes) the order goes by areas alone.
void reorder_by_rays(WideTree& tree, const TriangleSource& source,
                     std::span<const RepresentativeRay> rays, const NaryReorderConfig& config,
                     Memory& memory, const Parallel& parallel);

}  // namespace kiwami
