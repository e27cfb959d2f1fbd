// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_clusters.h"

namespace kiwami {

/// A receiver of the roulette, without its random number.
struct RouletteReceiver {
  float position[3];
  float normal[3];  ///< of length 1, or 0, 0, 0
  bool takes_both_sides;
  bool counts_cosine;  ///< whether lobes or spheres around the receiver bound the lights
  uint64_t link_mask;
};

/// A leaf that was accepted, and the probability with which it is.
struct AcceptedLeaf {
  uint32_t leaf;
  float probability;
};

/// Hierarchical Russian roulette over a perfect binary tree: each light is accepted with a
/// probability of its own, p = min(1, strength * energy * cosine / squared distance), by comparing
/// p with a number of its own; subtrees whose lights cannot be accepted are not visited.
///
/// After Y. Tokuyoshi and T. Harada, "Hierarchical Russian Roulette for Vertex Connections", TOG
/// 38(4), 2019, and, with spheres in place of lobes, "Stochastic Light Culling", JCGT 5(1), 2016;
/// the lobe is that of C. Dachsbacher and M. Stamminger, "Splatting Indirect Illumination", I3D
/// 2006. The numbers are those of S. Ogaki's talk "Acceleration Data Structures for Ray Tracing",
/// CEDEC 2019 (the lazy variant): one number R of as many bits as the tree has levels and one
/// uniform number xi give leaf i
/// ((i xor R) + xi) / 2^levels. Each is uniform, together they fill the unit interval evenly, and
/// the least of a subtree is known without looking at its leaves.
///
/// Departures: lights have extent, so the cosine is bounded over a light's box; subtrees are tested
/// by a bound of p over their box rather than by the shape of its level set, which is never less
/// tight.
class PerfectLightTree {
 public:
  /// The leaves in the depth-first order of the binary tree, so that neighbours are near.
  PerfectLightTree() = default;
  PerfectLightTree(const LightLinks& links, const Array<LightCluster>& clusters, Memory& memory);

  uint64_t bytes() const { return nodes_.bytes() + leaves_.bytes() + places_.bytes(); }
  bool empty() const { return leaves_.empty(); }

  /// By which energies are multiplied so that about `count` lights are accepted.
  double strength_for(const RouletteReceiver& receiver, double count) const;

  /// Calls accept(AcceptedLeaf) for each leaf that the numbers of random (0 to 1) accept.
  template <typename Accept>
  void play(const RouletteReceiver& receiver, double strength, double random,
            Accept&& accept) const;

  /// The probability with which a leaf is accepted.
  float probability(const RouletteReceiver& receiver, double strength, uint32_t leaf) const;

 private:
  struct Node {
    float centre[3], half_extent[3];
    float energy;  ///< of all leaves below; of a leaf its own
    float peak;    ///< the greatest of a leaf below
    uint64_t link_mask;
  };
  static constexpr uint32_t kNone = 0xFFFFFFFFu;

  static Node node_of(const LightCluster& cluster, double scale);
  static Node joined(const Node& left, const Node& right);
  double bound(const RouletteReceiver& receiver, const Node& node) const;
  double leaf_bound(const RouletteReceiver& receiver, const Node& node) const;

  Array<Node> nodes_;       ///< the children of i are 2i + 1 and 2i + 2
  Array<uint32_t> leaves_;  ///< by place: the leaf's number, or kNone where places are left over
  Array<uint32_t> places_;  ///< by leaf's number: its place, or kNone
  uint32_t level_count_ = 0;
  double least_square_ = 0.0;
};

template <typename Accept>
void PerfectLightTree::play(const RouletteReceiver& receiver, double strength, double random,
                            Accept&& accept) const {
  if (empty()) return;
  const double count = static_cast<double>(leaves_.size());
  const auto turn = static_cast<uint32_t>(random * count);
  const double rest = random * count - static_cast<double>(turn);
  struct Task {
    uint32_t prefix, level;  ///< of the node: the first bits of its leaves' places, and how many
  };
  Task stack[64];
  uint32_t size = 0;
  stack[size++] = {0, 0};
  while (size != 0) {
    const Task task = stack[--size];
    const uint32_t below = level_count_ - task.level;
    const Node& node = nodes_[(size_t{1} << task.level) - 1 + task.prefix];
    const uint64_t least = uint64_t{task.prefix ^ (turn >> below)} << below;
    const double number = (static_cast<double>(least) + rest) / count;
    if ((node.link_mask & receiver.link_mask) == 0) continue;
    if (below == 0) {
      const double probability = strength * leaf_bound(receiver, node);
      if (number < probability) {
        accept(AcceptedLeaf{leaves_[task.prefix],
                            static_cast<float>(probability < 1.0 ? probability : 1.0)});
      }
    } else if (number < strength * bound(receiver, node)) {
      stack[size++] = {2 * task.prefix + 1, task.level + 1};
      stack[size++] = {2 * task.prefix, task.level + 1};
    }
  }
}

}  // namespace kiwami
