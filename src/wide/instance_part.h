// SPDX-License-Identifier: Apache-2.0
// What a kernel needs of the instances of a scene.
#pragma once

#include "wide/instance_transform.h"
#include "wide/moving_boxes.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// One instance. A million of them may stand in a scene: 52 bytes each.
struct InstanceRecord {
  /// From the scene to the instanced one: where the axes and the origin go.
  float column[4][3];
  uint32_t prototype;  ///< an index
};
static_assert(sizeof(InstanceRecord) == 52);

/// What instances share.
struct Prototype {
  const SceneView* scene;
  uint32_t mask;  ///< of their geometry
};

/// A part of what an instance shows (re-braiding): a subtree in one of the trees of its scene.
struct InstanceStart {
  static constexpr uint32_t kAllTrees = 0xFFFFFFFFu;

  uint32_t instance;
  uint32_t tree;           ///< 0: that of the triangles; k + 1: that of part k; or kAllTrees
  ChildReference subtree;  ///< not used for kAllTrees
};

/// Instances are numbered through, by geometry and then by their index there. The leaves of the
/// part's tree hold these numbers, or those of starts where there are any. Plain data.
struct InstancePart {
  const InstanceRecord* instances;
  const Prototype* prototypes;
  const uint32_t* masks;        ///< of each instance; nullptr: all ones
  const InstanceStart* starts;  ///< nullptr: each instance starts with all
};

/// An array of instances that move. Plain data.
struct MovingArray {
  const float* steps;  ///< step_size_of(format) floats each, instance after instance
  TimeSteps time;
  TransformFormat format;
  uint32_t first;  ///< the number of its first instance
  uint32_t count;
  uint32_t is_regular;  ///< 1: none is singular or out of scale at any time
};

/// The instances that move, in the leaves of a tree of their own by their numbers. Plain data.
struct MovingInstancePart {
  InstancePart instances;     ///< all, of which those that move have no transforms here
  const MovingArray* arrays;  ///< by rising first
  uint32_t array_count;
  MovingBoxes boxes;
};

// Always inlined: objects of several instruction sets must not share one copy.

/// The array of an instance that moves.
__attribute__((always_inline)) inline const MovingArray& array_of(const MovingArray* arrays,
                                                                  uint32_t array_count,
                                                                  uint32_t number) {
  uint32_t low = 0, high = array_count;
  while (high - low > 1) {
    const uint32_t middle = low + (high - low) / 2;
    (arrays[middle].first <= number ? low : high) = middle;
  }
  return arrays[low];
}

/// The steps of an instance from one on.
__attribute__((always_inline)) inline const float* steps_of(const MovingArray& array,
                                                            uint32_t number, uint32_t step) {
  const uint64_t steps_before =
      uint64_t{number - array.first} * (array.time.segment_count + 1) + step;
  return array.steps + steps_before * step_size_of(array.format);
}

/// The matrix of an instance at a time; false where it does not exist then.
__attribute__((always_inline)) inline bool matrix_at(const MovingArray& array, uint32_t number,
                                                     float time, float (&rows)[12]) {
  TimePlace place;
  if (!place_in_time(array.time, time, place)) return false;
  matrix_between(steps_of(array, number, place.segment), array.format, place.fraction, rows);
  return true;
}

}  // namespace kiwami
