// SPDX-License-Identifier: Apache-2.0
#include "lights/light_clusters.h"

namespace kiwami {
namespace {

LightCluster cluster_of_leaf(const LightLeaves& leaves, uint32_t leaf) {
  const LightRecord& record = leaves[leaf];
  // A light that is linked to no receiver is dark.
  const double energy = record.link_mask != 0 ? record.energy() : 0.0;
  LightCluster cluster{record.box, record.cone(),   static_cast<double>(record.power),
                       energy,     energy * energy, energy > 0.0 ? record.link_mask : 0,
                       1};
  if (leaf >= leaves.light_count) {
    const InstanceLeaf& instance = leaves.instances[leaf - leaves.light_count];
    cluster.energy_square = instance.energy_square;
    cluster.light_count = instance.light_count;
  }
  return cluster;
}

LightCluster merged(const LightCluster& left, const LightCluster& right) {
  LightCluster cluster = left;
  cluster.box.extend(right.box);
  // What never shines shines nowhere.
  if (!(left.energy > 0.0)) {
    cluster.cone = right.cone;
  } else if (right.energy > 0.0) {
    cluster.cone = merge(left.cone, right.cone);
  }
  cluster.power += right.power;
  cluster.energy += right.energy;
  cluster.energy_square += right.energy_square;
  cluster.link_mask |= right.link_mask;
  cluster.light_count += right.light_count;
  return cluster;
}

}  // namespace

Array<LightCluster> clusters_of(const LightLinks& links, const LightLeaves& leaves,
                                Memory& memory) {
  Array<LightCluster> clusters(memory, links.size());
  for (size_t node = links.size(); node-- > 0;) {
    const uint32_t link = links[node];
    clusters[node] = is_light_leaf(link) ? cluster_of_leaf(leaves, link & ~kLightLeafBit)
                                         : merged(clusters[node + 1], clusters[link]);
  }
  return clusters;
}

AreaMeasure::AreaMeasure(const Bounds& root) : floor_(0.0) {
  const Vec3f extent = root.upper - root.lower;
  for (int axis = 0; axis < 3; ++axis) {
    const double size = static_cast<double>(extent[axis]);
    if (size > 0.0) floor_ += 1e-6 * size * size;
  }
  if (!(floor_ > 0.0)) floor_ = 1.0;
}

double AreaMeasure::operator()(const Bounds& box) const {
  if (box.is_empty()) return 0.0;
  const double x = static_cast<double>(box.upper.x) - static_cast<double>(box.lower.x);
  const double y = static_cast<double>(box.upper.y) - static_cast<double>(box.lower.y);
  const double z = static_cast<double>(box.upper.z) - static_cast<double>(box.lower.z);
  return 2.0 * (x * y + y * z + z * x) + floor_;
}

}  // namespace kiwami
