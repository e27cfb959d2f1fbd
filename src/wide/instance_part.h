// SPDX-License-Identifier: Apache-2.0
// What a kernel needs of the instances of a scene.
#pragma once

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

}  // namespace kiwami
