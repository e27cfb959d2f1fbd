// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_clusters.h"
#include "lights/roulette_numbers.h"

namespace kiwami {

/// Which roulette is played: what kiwami_light_query says of it, checked.
struct RouletteRules {
  uint32_t method;  ///< KIWAMI_LIGHT_METHOD_*
  uint32_t lobe;    ///< KIWAMI_LIGHT_LOBE_*
  uint32_t order;   ///< KIWAMI_LIGHT_ORDER_*
  double reach;     ///< 0: by the lights' extent
  uint32_t max_count;
  uint32_t sequence;  ///< KIWAMI_LIGHT_SEQUENCE_*
  uint32_t sequence_seed;
};

/// What belongs to a receiver beside itself; null where there is none.
struct RouletteExtras {
  const kiwami_light_lobe* lobe;
  const kiwami_light_pixel* pixel;
};

/// By what, besides energy and squared distance, a light is accepted.
enum class RouletteLobe {
  kSphere,  ///< nothing, of what is not below the tangent plane
  kCosine,
  kTangentSphere,
  kEllipsoid
};

/// A receiver of the roulette, without its random number.
struct RouletteReceiver {
  float position[3];
  float normal[3];  ///< of length 1, or 0, 0, 0
  bool takes_both_sides;
  bool has_normal;
  RouletteLobe lobe;
  float axis[3];        ///< of the ellipsoid, of length 1
  double eccentricity;  ///< of the ellipsoid, 0 to below 1
  uint64_t link_mask;
};

/// A leaf that was accepted, and the probability with which it is.
struct AcceptedLeaf {
  uint32_t leaf;
  float probability;
};

/// Hierarchical Russian roulette over a perfect binary tree: each light is accepted with a
/// probability of its own, p = min(1, strength * energy * lobe / squared distance), by comparing
/// p with a number of its own; subtrees whose lights cannot be accepted are not visited.
///
/// After Y. Tokuyoshi and T. Harada, "Hierarchical Russian Roulette for Vertex Connections", TOG
/// 38(4), 2019, and, with spheres in place of lobes, "Stochastic Light Culling", JCGT 5(1), 2016;
/// the lobe of the cosine is that of C. Dachsbacher and M. Stamminger, "Splatting Indirect
/// Illumination", I3D 2006; its square is a sphere that touches the tangent plane; the glossy one
/// is the squared polar radius of an ellipsoid with the receiver in a focus, which is what the GGX
/// distribution is of mirrored directions at normal incidence. The numbers: roulette_numbers.h.
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

  /// The same whatever the receiver is: all lights from as far as reach are about `count`. 0: the
  /// mean of the inverse square of the distance in a ball of their extent, from its middle.
  double strength_of_reach(double reach, double count) const;

  uint32_t level_count() const { return level_count_; }

  /// Calls accept(AcceptedLeaf) for each leaf that its number (see roulette_numbers.h) accepts.
  template <typename Numbers, typename Accept>
  void play(const RouletteReceiver& receiver, double strength, const Numbers& numbers,
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
  /// Lights below the squares of whose numbers are not less than this are not accepted; 0 where none
  /// is whose number is at least `least`.
  double squared_limit(const RouletteReceiver& receiver, const Node& node, double strength,
                       double least) const;
  double leaf_bound(const RouletteReceiver& receiver, const Node& node) const;

  Array<Node> nodes_;       ///< the children of i are 2i + 1 and 2i + 2
  Array<uint32_t> leaves_;  ///< by place: the leaf's number, or kNone where places are left over
  Array<uint32_t> places_;  ///< by leaf's number: its place, or kNone
  uint32_t level_count_ = 0;
  double least_square_ = 0.0;
};

template <typename Numbers, typename Accept>
void PerfectLightTree::play(const RouletteReceiver& receiver, double strength,
                            const Numbers& numbers, Accept&& accept) const {
  if (empty()) return;
  struct Task {
    uint32_t prefix, level;  ///< of the node: the first bits of its leaves' places, and how many
    typename Numbers::Value value;
  };
  Task stack[64];
  uint32_t size = 0;
  stack[size++] = {0, 0, numbers.root()};
  while (size != 0) {
    Task task = stack[--size];
    const uint32_t below = level_count_ - task.level;
    const size_t number = (size_t{1} << task.level) - 1 + task.prefix;
    const Node& node = nodes_[number];
    if ((node.link_mask & receiver.link_mask) == 0) continue;
    const double before = numbers.least(task.value, below);
    if (below == 0) {
      const double most = strength * leaf_bound(receiver, node);
      if (!(before < most)) continue;
      numbers.settle(task.value, below);
      if (!(numbers.least(task.value, below) < most)) continue;
      accept(AcceptedLeaf{leaves_[task.prefix], static_cast<float>(most < 1.0 ? most : 1.0)});
    } else {
      const double most = squared_limit(receiver, node, strength, before);
      if (!(before * before < most)) continue;
      numbers.settle(task.value, below);
      const double least = numbers.least(task.value, below);
      if (!(least * least < most)) continue;
      typename Numbers::Value values[2];
      numbers.divide(task.value, number, below, values);
      stack[size++] = {2 * task.prefix + 1, task.level + 1, values[1]};
      stack[size++] = {2 * task.prefix, task.level + 1, values[0]};
    }
  }
}

}  // namespace kiwami
