// SPDX-License-Identifier: Apache-2.0
#include "lights/perfect_light_tree.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiwami {
namespace {

/// Nodes of this level are asked for the strength.
constexpr uint32_t kEstimateLevel = 6;
/// More than rounding may take from a sum.
constexpr double kSumSlack = 1e-6;

float rounded_up(double value) {
  const float nearest = static_cast<float>(value);
  return static_cast<double>(nearest) < value
             ? std::nextafter(nearest, std::numeric_limits<float>::infinity())
             : nearest;
}

/// How a box is seen: in double, since the least number decides what is visited.
struct BoxView {
  double nearest_square = 0.0;  ///< of the box
  double middle_square = 0.0;   ///< of its middle
  double radius_square = 0.0;
  double offset[3], extent[3];

  BoxView(const RouletteReceiver& receiver, const float (&centre)[3], const float (&half)[3]) {
    for (int axis = 0; axis < 3; ++axis) {
      offset[axis] =
          static_cast<double>(centre[axis]) - static_cast<double>(receiver.position[axis]);
      extent[axis] = static_cast<double>(half[axis]);
      const double gap = std::max(std::fabs(offset[axis]) - extent[axis], 0.0);
      nearest_square += gap * gap;
      middle_square += offset[axis] * offset[axis];
      radius_square += extent[axis] * extent[axis];
    }
  }

  /// By how much the box rises along a direction, at most.
  double top(const float (&direction)[3], bool is_two_sided) const {
    double height = 0.0, rise = 0.0, size = 0.0;
    for (int axis = 0; axis < 3; ++axis) {
      const double along = static_cast<double>(direction[axis]);
      height += along * offset[axis];
      rise += std::fabs(along) * extent[axis];
      size += std::fabs(along) * std::fabs(offset[axis]);
    }
    if (is_two_sided) height = std::fabs(height);
    return height + rise + kSumSlack * (size + rise);
  }

  /// A bound of the cosine between a direction and those to the box; 0 where it is negative.
  double cosine(const float (&direction)[3], bool is_two_sided, double least_square) const {
    const double most = top(direction, is_two_sided);
    if (!(most > 0.0)) return 0.0;
    return std::min(1.0, most / std::sqrt(std::max(nearest_square, least_square)));
  }
};

/// A bound of the receiver's lobe over a box, relative to its peak: 0 below the tangent plane.
double lobe_of(const RouletteReceiver& receiver, const BoxView& view, double least_square) {
  double cosine = 1.0;
  if (receiver.has_normal) {
    cosine = view.cosine(receiver.normal, receiver.takes_both_sides, least_square);
    if (!(cosine > 0.0)) return 0.0;
  }
  switch (receiver.lobe) {
    case RouletteLobe::kSphere:
      return 1.0;
    case RouletteLobe::kCosine:
      return cosine;
    case RouletteLobe::kTangentSphere:
      return cosine * cosine;
    case RouletteLobe::kEllipsoid:
      break;
  }
  const double e = receiver.eccentricity;
  const double radius = (1.0 - e) / (1.0 - e * view.cosine(receiver.axis, false, least_square));
  return radius * radius;
}

}  // namespace

PerfectLightTree::Node PerfectLightTree::node_of(const LightCluster& cluster, double scale) {
  Node node{};
  for (int axis = 0; axis < 3; ++axis) {
    const double lower = static_cast<double>(cluster.box.lower[axis]);
    const double upper = static_cast<double>(cluster.box.upper[axis]);
    node.centre[axis] = static_cast<float>(0.5 * (lower + upper));
    const double middle = static_cast<double>(node.centre[axis]);
    node.half_extent[axis] = rounded_up(std::max(upper - middle, middle - lower));
  }
  const float scaled = static_cast<float>(cluster.energy * scale);
  node.energy = cluster.energy > 0.0 ? std::max(scaled, std::numeric_limits<float>::min()) : 0.0f;
  node.peak = node.energy;
  node.link_mask = cluster.link_mask;
  return node;
}

PerfectLightTree::Node PerfectLightTree::joined(const Node& left, const Node& right) {
  if (!(left.peak > 0.0f)) return right;
  if (!(right.peak > 0.0f)) return left;
  Node node = left;
  for (int axis = 0; axis < 3; ++axis) {
    const auto edge = [&](const Node& of, double side) {
      return static_cast<double>(of.centre[axis]) +
             side * static_cast<double>(of.half_extent[axis]);
    };
    const double lower = std::min(edge(left, -1.0), edge(right, -1.0));
    const double upper = std::max(edge(left, 1.0), edge(right, 1.0));
    node.centre[axis] = static_cast<float>(0.5 * (lower + upper));
    const double middle = static_cast<double>(node.centre[axis]);
    node.half_extent[axis] = rounded_up(std::max(upper - middle, middle - lower));
  }
  node.energy = left.energy + right.energy;
  node.peak = std::max(left.peak, right.peak);
  node.link_mask = left.link_mask | right.link_mask;
  return node;
}

PerfectLightTree::PerfectLightTree(const LightLinks& links, const Array<LightCluster>& clusters,
                                   Memory& memory) {
  if (links.empty() || !(clusters[0].energy > 0.0)) return;
  const size_t light_count = (links.size() + 1) / 2;
  while ((size_t{1} << level_count_) < light_count) ++level_count_;
  const size_t count = size_t{1} << level_count_;
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    const double extent = static_cast<double>(clusters[0].box.upper[axis]) -
                          static_cast<double>(clusters[0].box.lower[axis]);
    square += extent * extent;
  }
  least_square_ = std::max(square * 0x1p-48, 0x1p-100);
  const double scale = std::max(square, 0x1p-100) / clusters[0].energy;
  leaves_ = Array<uint32_t>(memory, count);
  nodes_ = Array<Node>(memory, 2 * count - 1);
  uint32_t greatest = 0, place = 0;
  for (size_t i = 0; i < links.size(); ++i) {
    if (!is_light_leaf(links[i])) continue;
    const uint32_t leaf = links[i] & ~kLightLeafBit;
    greatest = std::max(greatest, leaf);
    leaves_[place] = leaf;
    nodes_[count - 1 + place++] = node_of(clusters[i], scale);
  }
  for (; place < count; ++place) {
    leaves_[place] = kNone;
    nodes_[count - 1 + place] = Node{};
  }
  for (size_t i = count - 1; i-- > 0;) nodes_[i] = joined(nodes_[2 * i + 1], nodes_[2 * i + 2]);
  places_ = Array<uint32_t>(memory, size_t{greatest} + 1);
  std::fill(places_.begin(), places_.end(), kNone);
  for (uint32_t i = 0; i < light_count; ++i) places_[leaves_[i]] = i;
}

double PerfectLightTree::leaf_bound(const RouletteReceiver& receiver, const Node& node) const {
  const BoxView view(receiver, node.centre, node.half_extent);
  const double square = std::max({view.middle_square, view.radius_square, least_square_});
  return static_cast<double>(node.peak) * lobe_of(receiver, view, least_square_) / square;
}

double PerfectLightTree::strength_for(const RouletteReceiver& receiver, double count) const {
  if (empty()) return 0.0;
  const uint32_t level = std::min(level_count_, kEstimateLevel);
  double sum = 0.0;
  for (size_t i = (size_t{1} << level) - 1; i < (size_t{2} << level) - 1; ++i) {
    const Node& node = nodes_[i];
    if (!(node.peak > 0.0f) || (node.link_mask & receiver.link_mask) == 0) continue;
    const BoxView view(receiver, node.centre, node.half_extent);
    const double square = std::max({view.middle_square, view.radius_square, least_square_});
    sum += static_cast<double>(node.energy) * lobe_of(receiver, view, least_square_) / square;
  }
  return sum > 0.0 ? count / sum : 0.0;
}

double PerfectLightTree::strength_of_reach(double reach, double count) const {
  if (empty()) return 0.0;
  const Node& root = nodes_[0];
  double square = reach * reach;
  if (!(reach > 0.0)) {
    for (const float half : root.half_extent) {
      square += static_cast<double>(half) * static_cast<double>(half) / 3.0;
    }
    square = std::max(square, least_square_);
  }
  return count * square / static_cast<double>(root.energy);
}

float PerfectLightTree::probability(const RouletteReceiver& receiver, double strength,
                                    uint32_t leaf) const {
  if (leaf >= places_.size() || places_[leaf] == kNone) return 0.0f;
  const Node& node = nodes_[leaves_.size() - 1 + places_[leaf]];
  if ((node.link_mask & receiver.link_mask) == 0) return 0.0f;
  const double probability = strength * leaf_bound(receiver, node);
  return static_cast<float>(std::min(probability, 1.0));
}

}  // namespace kiwami
