// SPDX-License-Identifier: Apache-2.0
// The wide tree over lights as the kernels read it. Plain data.
#pragma once

#include <cstddef>
#include <cstdint>

namespace kiwami {

/// What a slot of a node refers to: a node, or with kLightLeafBit a light or an instance.
constexpr uint32_t kLightLeafBit = 0x80000000u;
constexpr uint32_t kNoLightSlot = 0xFFFFFFFFu;

/// The nodes above a light are at most as many: builders see to it.
constexpr uint32_t kMaxLightDepth = 96;

/// The choices of a receiver are at most as many.
constexpr uint32_t kMaxLightChoices = 64;

/// N children, field by field. An empty slot has energy 0.
template <int N>
struct LightNode {
  float centre[3][N];       ///< of the box
  float half_extent[3][N];  ///< rounded up: centre +- half_extent holds the box
  float radius[N];          ///< of the sphere around the box, rounded up
  float axis[3][N];         ///< of the cone, of length 1
  float cos_spread[N], sin_spread[N], cos_extent[N];
  float side[N];    ///< -1 for a child that shines about the opposite axis, too, else 1
  float energy[N];  ///< peak intensity, scaled (see LightTreeView::least_square)
  uint32_t child[N];
  uint64_t link_mask[N];  ///< of all lights below that have energy

  // What adaptive splitting asks of a cluster, in the units of energy.
  float mean_energy[N];      ///< of a light below
  float energy_variance[N];  ///< among the lights below
  float light_count[N];
};

/// A distant light, or an environment.
struct DistantLightView {
  float direction[3];  ///< towards the light, of length 1; 0, 0, 0 for an environment
  float cos_spread, sin_spread;
  float energy;
  uint32_t light_id;
  uint64_t link_mask;
};

struct LightInstanceView;

/// All that a kernel needs. Slot s of node n is number n * N + s.
struct LightTreeView {
  const void* nodes;             ///< LightNode<N>; node 0 is the root
  uint32_t node_count;           ///< 0: no light in the tree
  uint32_t light_count;          ///< leaves below are lights, those from here on instances
  const uint32_t* leaf_slots;    ///< by leaf: the slot that refers to it, or kNoLightSlot
  const uint32_t* parent_slots;  ///< by node: the slot that refers to it; kNoLightSlot for the root
  const uint32_t* user_ids;      ///< by light
  const LightInstanceView* instances;
  uint32_t instance_count;
  uint32_t distant_count;
  const DistantLightView* distant;
  double distant_probability;
  /// Of squared distances: nearer ones count as this. Energies are such that energy divided by it
  /// cannot overflow.
  float least_square;
  float root_centre[3], root_radius;  ///< of the sphere around all lights
  float root_energy;
  float root_mean_energy, root_energy_variance, root_light_count;  ///< as in LightNode
};

/// A tree seen through a transform.
struct LightInstanceView {
  float world_to_local[3][4];
  float normal_to_local[3][3];
  uint64_t link_mask;
  LightTreeView tree;
};

}  // namespace kiwami
