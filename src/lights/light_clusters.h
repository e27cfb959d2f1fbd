// SPDX-License-Identifier: Apache-2.0
// The binary tree over lights: its shape, and what is below each node.
#pragma once

#include "core/memory.h"
#include "lights/light_node.h"
#include "lights/light_record.h"

namespace kiwami {

/// An instance as a leaf of the tree.
struct InstanceLeaf {
  LightRecord record;    ///< of all of its lights together
  double energy_square;  ///< the sum of the squares of its lights' energies
  uint32_t light_count;
  uint32_t reserved;
};

/// The leaves by number: lights, then instances.
struct LightLeaves {
  const LightRecord* lights;
  const InstanceLeaf* instances;
  uint32_t light_count;
  uint32_t instance_count;

  uint32_t size() const { return light_count + instance_count; }
  const LightRecord& operator[](uint32_t leaf) const {
    return leaf < light_count ? lights[leaf] : instances[leaf - light_count].record;
  }
};

/// The shape of a binary tree in depth-first order: the left child of node i is i + 1, its right
/// child links[i]. A leaf has kLightLeafBit and the number of its leaf.
using LightLinks = Array<uint32_t>;

inline bool is_light_leaf(uint32_t link) { return (link & kLightLeafBit) != 0; }

/// What is at or below a node.
struct LightCluster {
  Bounds box;
  Cone cone;
  double power;
  double energy;         ///< summed over its lights, as is
  double energy_square;  ///< the square of each
  uint64_t link_mask;    ///< of the lights that have energy
  uint32_t light_count;
};

/// The clusters of all nodes, children before parents: the tree's bounds, anew after lights
/// changed.
Array<LightCluster> clusters_of(const LightLinks& links, const LightLeaves& leaves, Memory& memory);

/// M_A of Conty Estevez & Kulla 2018: the surface area of a box. A little of the root's square is
/// added, so that points and lines have a measure, too.
class AreaMeasure {
 public:
  explicit AreaMeasure(const Bounds& root);
  double operator()(const Bounds& box) const;

 private:
  double floor_;
};

}  // namespace kiwami
