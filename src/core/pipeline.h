// SPDX-License-Identifier: Apache-2.0
// From the numbers of methods to the calls: primitives to a binary tree, and what improves this and
// the wide tree.
#pragma once

#include "bvh/binary_bvh.h"
#include "bvh/triangle_source.h"
#include "core/scene_parameters.h"
#include "parallel/parallel.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// The name of a method of a KIWAMI_STAGE_*; nullptr where there is none of this number.
const char* method_name(uint32_t stage, uint32_t method);

/// The highest number of a method of a stage; there may be gaps below it.
uint32_t highest_method(uint32_t stage);

/// The most primitives that a leaf of the binary tree owns, for a wide tree of this width.
uint32_t binary_leaf_size_of(const SceneParameters& parameters, uint32_t width);

/// How a wide tree of this width is made of a binary one.
WideTreeConfig wide_tree_config(const SceneParameters& parameters, uint32_t width);

/// Runs the builder that the parameters name, and those of their optimisers that act on the binary
/// tree. The primitives are those of the source that can be hit; rays are for builders that go by
/// them. Where there is to be a binary tree, WIDE_TOP_DOWN is as BINNED_SAH and WIDE_LINEAR as LBVH by
/// extended codes: the same splits.
BinaryBvh build_binary_bvh(Array<BuildPrimitive> primitives, const TriangleSource& source,
                           std::span<const RepresentativeRay> rays,
                           const SceneParameters& parameters, uint32_t width, Memory& memory,
                           const Parallel& parallel);

/// Rays for the methods that go by rays, where there are none of the user's: none where no method
/// that the parameters name does.
Array<RepresentativeRay> sample_rays_for(const SceneParameters& parameters,
                                         const TriangleSource& source, Memory& memory);

/// Runs those of the optimisers that act on the wide tree. A tree over boxes has a source without
/// meshes.
void optimize_wide_tree(WideTree& tree, const TriangleSource& source,
                        std::span<const RepresentativeRay> rays, const SceneParameters& parameters,
                        Memory& memory, const Parallel& parallel);

/// Whether the builder makes the wide tree itself: where it has a binary twin, as long as nothing
/// asks for a binary tree.
bool builds_wide_tree(const SceneParameters& parameters);

/// Runs such a builder. Throws Error(INVALID_ARGUMENT) where optimisers of binary trees
/// are set.
WideDraft build_wide_draft(Array<BuildPrimitive> primitives, const WideTreeConfig& config,
                           const SceneParameters& parameters, Memory& memory,
                           const Parallel& parallel);

}  // namespace kiwami
