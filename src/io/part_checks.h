// SPDX-License-Identifier: Apache-2.0
// What kernels rely on in the parts of a scene beside their trees, of files that nobody vouches
// for.
#pragma once

#include <span>

#include "core/memory.h"
#include "core/saved_scene.h"
#include "io/tree_sections.h"
#include "parallel/parallel.h"

namespace kiwami::file {

/// A committed array of instances.
struct InstanceArray {
  IdRange numbers;
  const unsigned char* matrices;  ///< 12 floats of each; nullptr: they move
  const uint32_t* indices;        ///< of each, among the scenes that it shows; nullptr: 0
  uint32_t scene_count;
};

/// What the committed instances of a scene are.
struct InstanceContents {
  std::span<const uint32_t> shown;  ///< the scenes that they show, by their numbers in the file
  std::span<const InstanceArray> arrays;
  std::span<const IdRange> resting, moving;  ///< their own numbers
};

/// Checks that every instance is of one of the shown scenes and, where it rests, can be entered, as
/// it was committed and as its array has it now; and that re-braided ones, which rest, start at
/// references of their trees, which have been checked. Throws Error(INVALID_FILE).
void check_instances(const SavedInstances& instances, const InstanceContents& contents,
                     const SavedForest& forest, const Parallel& parallel);

/// Checks that instances of one array that move can be entered at their steps, of which each has so
/// many, and at any time where they are said to be regular: see MovingArray. Throws
/// Error(INVALID_FILE).
void check_instance_steps(std::span<const float> steps, TransformFormat format, uint32_t step_count,
                          bool is_regular, const Parallel& parallel);

/// Checks that boxes of what moves are finite. Throws Error(INVALID_FILE).
void check_moving_boxes(std::span<const float> bounds, const Parallel& parallel);

}  // namespace kiwami::file
