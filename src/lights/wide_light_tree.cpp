// SPDX-License-Identifier: Apache-2.0
#include "lights/wide_light_tree.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

namespace kiwami {
namespace {

float rounded_up(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

/// A box as centre and half extents that hold it, and the sphere around it.
struct RoundBox {
  float centre[3], half_extent[3], radius;

  explicit RoundBox(const Bounds& box) : centre{}, half_extent{}, radius(0.0f) {
    double square = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double lower = static_cast<double>(box.lower[axis]);
      const double upper = static_cast<double>(box.upper[axis]);
      centre[axis] = static_cast<float>(0.5 * (lower + upper));
      const double middle = static_cast<double>(centre[axis]);
      half_extent[axis] = rounded_up(std::max(upper - middle, middle - lower));
      square += static_cast<double>(half_extent[axis]) * static_cast<double>(half_extent[axis]);
    }
    // A little more: kernels take the distance from it in float.
    radius = rounded_up(std::sqrt(square) * 1.000001);
  }
};

/// What energies are multiplied by: with it, those of a tree divided by squared distances are
/// about 1 at the distance of its size.
double energy_scale(const LightCluster& root) {
  const double diameter = 2.0 * static_cast<double>(RoundBox(root.box).radius);
  const double square = std::max(diameter * diameter, 0x1p-100);
  return root.energy > 0.0 ? square / root.energy : 0.0;
}

float scaled_energy(double energy, double scale) {
  const float scaled = static_cast<float>(energy * scale);
  return energy > 0.0 ? std::max(scaled, std::numeric_limits<float>::min()) : 0.0f;
}

template <int N>
void clear_slot(LightNode<N>& node, int slot) {
  for (int axis = 0; axis < 3; ++axis) {
    node.centre[axis][slot] = node.half_extent[axis][slot] = node.axis[axis][slot] = 0.0f;
  }
  node.radius[slot] = node.sin_spread[slot] = node.energy[slot] = 0.0f;
  node.cos_spread[slot] = node.cos_extent[slot] = node.side[slot] = 1.0f;
  node.mean_energy[slot] = node.energy_variance[slot] = node.light_count[slot] = 0.0f;
  node.child[slot] = kNoLightSlot;
  node.link_mask[slot] = 0;
}

/// What adaptive splitting asks, in the units of scaled energies.
struct Moments {
  float mean, variance, count;

  Moments(const LightCluster& cluster, double scale)
      : count(static_cast<float>(cluster.light_count)) {
    const double lights = cluster.light_count;
    const double average = cluster.energy / lights * scale;
    const double square = cluster.energy_square / lights * scale * scale;
    constexpr double kGreatest = std::numeric_limits<float>::max();
    mean = static_cast<float>(average);
    variance = static_cast<float>(std::clamp(square - average * average, 0.0, kGreatest));
  }
};

template <int N>
void write_slot(LightNode<N>& node, int slot, const LightCluster& cluster, uint32_t child,
                double scale) {
  const RoundBox box(cluster.box);
  const Cone cone = cluster.cone.is_empty ? Cone::sphere() : cluster.cone;
  const double axis[3] = {cone.axis.x, cone.axis.y, cone.axis.z};
  for (int i = 0; i < 3; ++i) {
    node.centre[i][slot] = box.centre[i];
    node.half_extent[i][slot] = box.half_extent[i];
    node.axis[i][slot] = static_cast<float>(axis[i]);
  }
  node.radius[slot] = box.radius;
  node.cos_spread[slot] = static_cast<float>(cone.spread.cosine);
  node.sin_spread[slot] = static_cast<float>(cone.spread.sine);
  node.cos_extent[slot] = static_cast<float>(cone.extent.cosine);
  node.side[slot] = cone.is_two_sided ? -1.0f : 1.0f;
  node.energy[slot] = scaled_energy(cluster.energy, scale);
  const Moments moments(cluster, scale);
  node.mean_energy[slot] = moments.mean;
  node.energy_variance[slot] = moments.variance;
  node.light_count[slot] = moments.count;
  node.child[slot] = child;
  node.link_mask[slot] = cluster.link_mask;
}

double cost_of(const LightCluster& cluster, const AreaMeasure& area_measure) {
  return cluster.power * area_measure(cluster.box) * orientation_measure(cluster.cone);
}

/// Nodes, and who refers to whom, from slot_clusters. Nodes are numbered breadth first, so the
/// next inner cluster among the slots is the next node.
template <int N>
void write_nodes(const LightLinks& links, const Array<LightCluster>& clusters, size_t leaf_count,
                 Memory& memory, WideLightTree& tree) {
  tree.nodes = Array<unsigned char>(memory, tree.node_count * sizeof(LightNode<N>));
  tree.leaf_slots = Array<uint32_t>(memory, leaf_count);
  std::fill(tree.leaf_slots.begin(), tree.leaf_slots.end(), kNoLightSlot);
  tree.parent_slots = Array<uint32_t>(memory, tree.node_count);
  tree.parent_slots[0] = kNoLightSlot;
  const AreaMeasure area_measure(clusters[0].box);
  const double scale = energy_scale(clusters[0]);
  auto* nodes = reinterpret_cast<LightNode<N>*>(tree.nodes.data());
  double cost = 0.0;
  uint32_t next_node = 1;
  for (uint32_t slot = 0; slot < tree.node_count * N; ++slot) {
    LightNode<N>& node = nodes[slot / N];
    const uint32_t cluster = tree.slot_clusters[slot];
    if (cluster == kNoLightSlot) {
      clear_slot(node, static_cast<int>(slot % N));
      continue;
    }
    const uint32_t link = links[cluster];
    if (is_light_leaf(link)) {
      tree.leaf_slots[link & ~kLightLeafBit] = slot;
    } else {
      tree.parent_slots[next_node] = slot;
    }
    write_slot(node, static_cast<int>(slot % N), clusters[cluster],
               is_light_leaf(link) ? link : next_node++, scale);
    cost += cost_of(clusters[cluster], area_measure);
  }
  const double root_cost = cost_of(clusters[0], area_measure);
  tree.cost = root_cost > 0.0 ? cost / root_cost : 0.0;
}

void write_any(const LightLinks& links, const Array<LightCluster>& clusters, size_t leaf_count,
               Memory& memory, WideLightTree& tree) {
  switch (slots_of(tree.width)) {
    case 4:
      return write_nodes<4>(links, clusters, leaf_count, memory, tree);
    case 8:
      return write_nodes<8>(links, clusters, leaf_count, memory, tree);
    default:
      return write_nodes<16>(links, clusters, leaf_count, memory, tree);
  }
}

/// The clusters that become the slots of a node over root; returns how many.
uint32_t open_clusters(uint32_t root, const LightLinks& links, const Array<double>& costs,
                       uint32_t width, uint32_t (&slots)[16]) {
  uint32_t count = 1;
  slots[0] = root;
  while (count < width) {
    uint32_t dearest = kNoLightSlot;
    for (uint32_t i = 0; i < count; ++i) {
      if (is_light_leaf(links[slots[i]])) continue;
      if (dearest == kNoLightSlot || costs[slots[i]] > costs[slots[dearest]]) dearest = i;
    }
    if (dearest == kNoLightSlot) break;
    const uint32_t opened = slots[dearest];
    // Keeps the depth-first order of the binary tree.
    for (uint32_t i = count; i > dearest + 1; --i) slots[i] = slots[i - 1];
    slots[dearest] = opened + 1;
    slots[dearest + 1] = links[opened];
    ++count;
  }
  return count;
}

}  // namespace

WideLightTree contract(const LightLinks& links, const Array<LightCluster>& clusters, uint32_t width,
                       uint32_t leaf_count, Memory& memory) {
  const AreaMeasure area_measure(clusters[0].box);
  Array<double> costs(memory, clusters.size());
  for (size_t i = 0; i < costs.size(); ++i) costs[i] = cost_of(clusters[i], area_measure);
  WideLightTree tree;
  tree.width = width;
  struct Pending {
    uint32_t cluster, depth;
  };
  GrowingArray<Pending> pending(memory);  // in the order of node numbers
  GrowingArray<uint32_t> slot_clusters(memory);
  pending.push_back({0, 1});
  for (size_t node = 0; node < pending.size(); ++node) {
    const Pending task = pending[node];
    tree.depth = std::max(tree.depth, task.depth);
    uint32_t slots[16];
    const uint32_t count = open_clusters(task.cluster, links, costs, width, slots);
    for (uint32_t slot = 0; slot < slots_of(width); ++slot) {
      slot_clusters.push_back(slot < count ? slots[slot] : kNoLightSlot);
      if (slot < count && !is_light_leaf(links[slots[slot]])) {
        pending.push_back({slots[slot], task.depth + 1});
      }
    }
  }
  tree.node_count = static_cast<uint32_t>(pending.size());
  tree.slot_clusters = slot_clusters.take();
  write_any(links, clusters, leaf_count, memory, tree);
  return tree;
}

WideLightTree rewritten(const WideLightTree& shape, const LightLinks& links,
                        const Array<LightCluster>& clusters, uint32_t leaf_count, Memory& memory) {
  WideLightTree tree;
  tree.width = shape.width;
  tree.node_count = shape.node_count;
  tree.depth = shape.depth;
  tree.slot_clusters = Array<uint32_t>(memory, shape.slot_clusters.size());
  std::memcpy(tree.slot_clusters.data(), shape.slot_clusters.data(), shape.slot_clusters.bytes());
  write_any(links, clusters, leaf_count, memory, tree);
  return tree;
}

void describe_root(const LightCluster& root, LightTreeView& view) {
  const RoundBox box(root.box);
  for (int axis = 0; axis < 3; ++axis) view.root_centre[axis] = box.centre[axis];
  view.root_radius = box.radius;
  const double scale = energy_scale(root);
  const Moments moments(root, scale);
  view.root_energy = scaled_energy(root.energy, scale);
  view.root_mean_energy = moments.mean;
  view.root_energy_variance = moments.variance;
  view.root_light_count = moments.count;
  // Coordinates do not tell nearer points apart; see energy_scale for what it is divided by.
  const double diameter = 2.0 * static_cast<double>(box.radius);
  view.least_square = static_cast<float>(std::max(diameter * diameter * 0x1p-48, 0x1p-100));
}

}  // namespace kiwami
