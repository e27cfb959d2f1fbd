// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "lights/light_clusters.h"
#include "lights/roulette_bound.h"
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
  using Node = RouletteNode;
  static constexpr uint32_t kNone = 0xFFFFFFFFu;

  static Node node_of(const LightCluster& cluster, double scale);
  static Node joined(const Node& left, const Node& right);
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

    size_t number() const { return (size_t{1} << level) - 1 + prefix; }
  };
  const RouletteBound bound(receiver, strength, least_square_);
  // What is left to do for a node, or for a leaf: settle_by(admits) has its number, if admitted.
  const auto enters = [&](const Task& task, const auto& settle_by) {
    const Node& node = nodes_[task.number()];
    if ((node.link_mask & receiver.link_mask) == 0) return false;
    const double before = numbers.least_bound(task.value, level_count_ - task.level);
    const RouletteLimit limit = bound.limit_of(node, before);
    return limit.admits(before) && settle_by([&](double least) { return limit.admits(least); });
  };
  const auto visit_leaf = [&](const Task& task, const auto& settle_by) {
    const Node& node = nodes_[task.number()];
    if ((node.link_mask & receiver.link_mask) == 0) return;
    const double most = strength * leaf_bound(receiver, node);
    if (!(numbers.least_bound(task.value, 0) < most)) return;
    if (!settle_by([&](double least) { return least < most; })) return;
    if (!numbers.accepts(task.value, most)) return;
    accept(AcceptedLeaf{leaves_[task.prefix], static_cast<float>(most < 1.0 ? most : 1.0)});
  };
  const auto is_settled = [](const auto&) { return true; };
  Task task{0, 0, numbers.root()};
  if (level_count_ == 0) return visit_leaf(task, is_settled);
  if (!enters(task, is_settled)) return;
  Task stack[64];
  uint32_t size = 0;
  for (;;) {
    const size_t parent = task.number();
    const uint32_t below = level_count_ - task.level - 1;
    typename Numbers::Value values[2];
    const uint32_t side = numbers.divide(task.value, parent, below + 1, values);
    Task first{2 * task.prefix + side, task.level + 1, values[0]};
    Task second{2 * task.prefix + (side ^ 1), task.level + 1, values[1]};
    const auto settle_second = [&](const auto& admits) {
      return numbers.settle(second.value, parent, below, admits);
    };
    if (below == 0) {
      visit_leaf(first, is_settled);
      visit_leaf(second, settle_second);
    } else {
      if (enters(second, settle_second)) stack[size++] = second;
      if (enters(first, is_settled)) {
        task = first;
        continue;
      }
    }
    if (size == 0) return;
    task = stack[--size];
  }
}

}  // namespace kiwami
