// SPDX-License-Identifier: Apache-2.0
// Adaptive tree splitting: where a cluster of lights is a poor predictor of what its lights
// contribute, all of its children are taken in place of one of them (Conty Estevez & Kulla,
// "Importance Sampling of Many Lights with Adaptive Tree Splitting", PACMCGIT 1(2) (HPG), 2018).
//
// With lightcuts, the cut is that of C. Yuksel, "Stochastic Lightcuts", HPG 2019: the cluster that
// can contribute most is split next, as long as there is room; so it does not depend on what is
// chosen, and the estimate is unbiased.
//
// Departures: the deviation of a cluster counts relative to what all lights together are estimated
// to contribute, so that the threshold has no unit; clusters are looked at in the order of the
// tree's levels and opened as long as the choices suffice for all of their children; each branch
// has a random number of its own, mixed from the receiver's, so that branches are independent.
#pragma once

#include "kernels/light-sample-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

constexpr uint32_t kNoInstance = 0xFFFFFFFFu;

/// A branch of the split tree: a light, or a cluster of lights of which one is to be chosen.
struct LightBranch {
  uint32_t instance;  ///< in whose tree it is, or kNoInstance
  uint32_t child;     ///< as in LightNode
};

/// What the decision about a cluster needs, in the units of the whole tree.
struct LightSpread {
  double centre[3];
  double radius;
  double mean, variance, count;
};

/// The branches of a receiver: a function of the receiver without its random number.
struct LightCut {
  LightBranch branches[kMaxLightChoices];
  uint32_t count;
};

/// The squared distance of a point, or of the nearest point of a segment.
inline double square_distance(const LightPoint& point, const double (&centre)[3]) {
  double offset[3], along[3], product = 0.0, square = 0.0;
  for (int i = 0; i < 3; ++i) {
    along[i] = static_cast<double>(point.segment[i]);
    offset[i] = centre[i] - static_cast<double>(point.position[i]);
    product += offset[i] * along[i];
    square += along[i] * along[i];
  }
  double place = point.has_segment && square > 0.0 ? product / square : 0.0;
  place = place < 0.0 ? 0.0 : place > 1.0 ? 1.0 : place;
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const double gap = offset[i] - place * along[i];
    sum += gap * gap;
  }
  return sum;
}

/// What all lights together contribute, roughly.
inline double total_estimate(const LightTreeView& tree, const LightPoint& point) {
  const double centre[3] = {static_cast<double>(tree.root_centre[0]),
                            static_cast<double>(tree.root_centre[1]),
                            static_cast<double>(tree.root_centre[2])};
  const double radius = static_cast<double>(tree.root_radius);
  const double square = square_distance(point, centre);
  const double reach = radius * radius > static_cast<double>(tree.least_square)
                           ? radius * radius
                           : static_cast<double>(tree.least_square);
  return static_cast<double>(tree.root_energy) / (square > reach ? square : reach);
}

/// The standard deviation of what a cluster contributes, as if its lights lay at any distance
/// between those of its sphere's nearest and farthest point; negative within the sphere, where
/// there is none.
inline double deviation_of(const LightSpread& spread, const LightPoint& point) {
  const double distance = __builtin_sqrt(square_distance(point, spread.centre));
  if (distance <= spread.radius) return -1.0;
  const double nearest = distance - spread.radius, farthest = distance + spread.radius;
  const double product = nearest * farthest;
  const double mean = 1.0 / product;
  const double width = farthest - nearest;
  const double variance = width * width / (3.0 * product * product * product);
  const double sum = spread.variance * variance + spread.variance * mean * mean +
                     spread.mean * spread.mean * variance;
  return __builtin_sqrt(sum) * spread.count;
}

template <int N>
inline LightSpread cluster_spread(const LightNode<N>& node, int slot) {
  LightSpread spread;
  for (int i = 0; i < 3; ++i) spread.centre[i] = static_cast<double>(node.centre[i][slot]);
  spread.radius = static_cast<double>(node.radius[slot]);
  spread.mean = static_cast<double>(node.mean_energy[slot]);
  spread.variance = static_cast<double>(node.energy_variance[slot]);
  spread.count = static_cast<double>(node.light_count[slot]);
  return spread;
}

/// A receiver, in the coordinates of the tree and of one instance at a time.
struct SplitPoints {
  const LightTreeView* tree;
  const LightPoint* outer;
  LightPoint inner;
  uint32_t inner_instance;

  const LightPoint& of(uint32_t instance) {
    if (instance == kNoInstance) return *outer;
    if (inner_instance != instance) {
      inner = transformed(*outer, tree->instances[instance]);
      inner_instance = instance;
    }
    return inner;
  }
  const LightTreeView& tree_of(uint32_t instance) const {
    return instance == kNoInstance ? *tree : tree->instances[instance].tree;
  }
};

/// From the units of an instance's tree to those of the whole: of energies over squared lengths.
template <int N>
inline double unit_of(const LightTreeView& tree, uint32_t instance) {
  if (instance == kNoInstance) return 1.0;
  const uint32_t slot = tree.leaf_slots[tree.light_count + instance];
  const LightNode<N>& node = node_of<N>(tree, slot / N);
  const LightTreeView& inner = tree.instances[instance].tree;
  const double energy = static_cast<double>(node.energy[slot % N]);
  const double inner_energy = static_cast<double>(inner.root_energy);
  const double radius = static_cast<double>(node.radius[slot % N]);
  const double inner_radius = static_cast<double>(inner.root_radius);
  const double scale = inner_radius > 0.0 && radius > 0.0 ? radius / inner_radius : 1.0;
  return inner_energy > 0.0 ? energy / inner_energy / (scale * scale) : 0.0;
}

/// A branch that waits for the decision whether it is split.
struct WaitingBranch {
  LightBranch branch;
  bool is_spread;  ///< whether it is to be split if there is room
  double bound;    ///< of lightcuts: of what it contributes at most
};

/// The children of a branch that can contribute, as waiting branches; returns how many.
template <int N>
inline uint32_t children_of(SplitPoints& points, LightBranch branch, double limit, double estimate,
                            WaitingBranch (&children)[N]) {
  // An instance opens the root of its tree.
  const bool is_instance = (branch.child & kLightLeafBit) != 0;
  const uint32_t instance =
      is_instance ? (branch.child & ~kLightLeafBit) - points.tree->light_count : branch.instance;
  const LightTreeView& tree = points.tree_of(instance);
  const LightPoint& point = points.of(instance);
  const LightNode<N>& node = node_of<N>(tree, is_instance ? 0 : branch.child);
  LightShares<N> shares;
  share_by_importance(tree, node, point, shares);
  const double unit = unit_of<N>(*points.tree, instance);
  uint32_t count = 0;
  for (int slot = 0; slot < N; ++slot) {
    if (!(shares.importance[slot] > 0.0f)) continue;
    const double deviation = deviation_of(cluster_spread(node, slot), point);
    const bool is_spread =
        point.is_lightcut || deviation < 0.0 || deviation * unit >= limit * estimate;
    children[count++] = {
        {instance, node.child[slot]}, is_spread, static_cast<double>(shares.bound[slot]) * unit};
  }
  return count;
}

inline bool is_light(const SplitPoints& points, LightBranch branch) {
  if ((branch.child & kLightLeafBit) == 0) return false;
  return branch.instance != kNoInstance ||
         (branch.child & ~kLightLeafBit) < points.tree->light_count;
}

/// Swaps the branch of the greatest bound, of equal ones the first, to the front of a ring.
inline void put_greatest_first(WaitingBranch* waiting, uint32_t first, uint32_t count) {
  uint32_t greatest = first;
  for (uint32_t i = 1; i < count; ++i) {
    const uint32_t place = (first + i) % kMaxLightChoices;
    if (waiting[place].bound > waiting[greatest].bound) greatest = place;
  }
  const WaitingBranch front = waiting[first];
  waiting[first] = waiting[greatest];
  waiting[greatest] = front;
}

/// Splits from the root on, at most into max_count branches.
template <int N>
inline void cut_tree(SplitPoints& points, double limit, uint32_t max_count, LightCut& cut) {
  const LightTreeView& tree = *points.tree;
  const double estimate = total_estimate(tree, *points.outer);
  WaitingBranch waiting[kMaxLightChoices];  // a ring
  uint32_t first = 0, waiting_count = 1;
  LightSpread root;
  for (int i = 0; i < 3; ++i) root.centre[i] = static_cast<double>(tree.root_centre[i]);
  root.radius = static_cast<double>(tree.root_radius);
  root.count = static_cast<double>(tree.root_light_count);
  root.mean = static_cast<double>(tree.root_mean_energy);
  root.variance = static_cast<double>(tree.root_energy_variance);
  const double deviation = deviation_of(root, *points.outer);
  const bool is_lightcut = points.outer->is_lightcut;
  waiting[0] = {
      {kNoInstance, 0}, is_lightcut || deviation < 0.0 || deviation >= limit * estimate, 0.0};
  cut.count = 0;
  while (waiting_count != 0) {
    if (is_lightcut) put_greatest_first(waiting, first, waiting_count);
    const WaitingBranch next = waiting[first];
    first = (first + 1) % kMaxLightChoices;
    --waiting_count;
    WaitingBranch children[N];
    uint32_t count = 0;
    bool is_split =
        next.is_spread && !is_light(points, next.branch) && (is_lightcut || limit < 1e30);
    if (is_split) {
      count = children_of<N>(points, next.branch, limit, estimate, children);
      is_split = cut.count + waiting_count + count <= max_count;
    }
    if (!is_split) {
      cut.branches[cut.count++] = next.branch;
      continue;
    }
    for (uint32_t i = 0; i < count; ++i) {
      waiting[(first + waiting_count++) % kMaxLightChoices] = children[i];
    }
  }
}

/// A random number of its own for branch number index: the finalizer of Stafford's Mix13 over the
/// receiver's bits (S. Vigna's SplitMix64).
inline double branch_random(double random, uint32_t index) {
  if (index == 0) return random;
  uint64_t bits;
  __builtin_memcpy(&bits, &random, sizeof bits);
  bits += uint64_t{index} * 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  bits ^= bits >> 31;
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// Chooses one light of a branch.
template <int N>
inline void choose_of_branch(SplitPoints& points, LightBranch branch, double random,
                             kiwami_light_choice& choice) {
  const LightTreeView& tree = points.tree_of(branch.instance);
  const LightPoint& point = points.of(branch.instance);
  LightShares<N> shares;
  LightPath path{branch.child & ~kLightLeafBit, 1.0, random};
  if ((branch.child & kLightLeafBit) == 0) {
    share(tree, node_of<N>(tree, branch.child), point, shares);
    if (!(shares.total() > 0.0)) return write_none(choice);
    descend(tree, point, branch.child, shares, path);
  }
  if (branch.instance == kNoInstance) return finish(tree, point, shares, path, choice);
  choice = {path.leaf, branch.instance, tree.user_ids[path.leaf],
            returned_probability(path.probability), path.random};
}

/// The branches of a receiver and whether distant lights get one choice beside them.
template <int N>
inline bool prepare_cut(const LightTreeView& tree, const LightPoint& point, SplitPoints& points,
                        const LightBatch& batch, LightCut& cut, double& distant_total) {
  points = {&tree, &point, point, kNoInstance};
  cut.count = 0;
  distant_total = total_distant_importance(tree, point);
  bool has_tree = false;
  if (tree.node_count != 0) {
    LightShares<N> shares;
    share_by_importance(tree, node_of<N>(tree, 0), point, shares);
    has_tree = shares.total() > 0.0;
  }
  const bool has_distant = distant_total > 0.0;
  if (has_tree) {
    cut_tree<N>(points, batch.split_limit, batch.max_choices - (has_distant ? 1 : 0), cut);
  }
  return has_distant;
}

template <int N>
inline void split_one(const LightTreeView& tree, const LightBatch& batch, size_t number,
                      kiwami_light_choice* choices) {
  for (uint32_t i = 0; i < batch.max_choices; ++i) write_none(choices[i]);
  kiwami_light_receiver receiver;
  LightPoint point;
  if (!read_receiver(batch, number, receiver, point)) return;
  SplitPoints points;
  LightCut cut;
  double distant_total;
  uint32_t count = 0;
  double random = receiver.random > 0.0 ? receiver.random : 0.0;
  if (random > kGreatestRandom) random = kGreatestRandom;
  if (prepare_cut<N>(tree, point, points, batch, cut, distant_total)) {
    choose_distant(tree, point, distant_total, 1.0, branch_random(random, cut.count),
                   choices[count++]);
  }
  for (uint32_t i = 0; i < cut.count; ++i) {
    kiwami_light_choice& choice = choices[count];
    choose_of_branch<N>(points, cut.branches[i], branch_random(random, i), choice);
    if (choice.light_id != KIWAMI_INVALID_ID) ++count;
  }
}

/// The probability with which a light is chosen of a branch: 0 where it is of another.
template <int N>
inline double branch_probability(SplitPoints& points, LightBranch branch,
                                 const kiwami_light_name& name) {
  if (branch.instance == kNoInstance) {
    return tree_pdf<N>(*points.tree, *points.outer, branch.child, true, name, 1.0);
  }
  if (branch.instance != name.instance_id) return 0.0;
  if (branch.child & kLightLeafBit) {
    return (branch.child & ~kLightLeafBit) == name.light_id ? 1.0 : 0.0;
  }
  return path_probability<N>(points.tree_of(branch.instance), points.of(branch.instance),
                             branch.child, name.light_id, true, 1.0);
}

template <int N>
inline float split_pdf_of(const LightTreeView& tree, const LightBatch& batch, size_t number,
                          const kiwami_light_name& name) {
  kiwami_light_receiver receiver;
  LightPoint point;
  if (!read_receiver(batch, number, receiver, point) || !is_name_of_light(tree, name)) return 0.0f;
  SplitPoints points;
  LightCut cut;
  double distant_total;
  if (prepare_cut<N>(tree, point, points, batch, cut, distant_total)) {
    const double own = share_of_distant(tree, point, name, distant_total);
    if (own > 0.0) return returned_probability(own);
  }
  for (uint32_t i = 0; i < cut.count; ++i) {
    const double probability = branch_probability<N>(points, cut.branches[i], name);
    if (probability > 0.0) return returned_probability(probability);
  }
  return 0.0f;
}

template <int N>
void split_batch(const LightTreeView& tree, const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_choice choices[kMaxLightChoices];
    split_one<N>(tree, batch, i, choices);
    for (uint32_t k = 0; k < batch.max_choices; ++k) {
      __builtin_memcpy(batch.answers + (i * batch.max_choices + k) * batch.answer_stride,
                       &choices[k], sizeof choices[k]);
    }
  }
}

template <int N>
void split_pdf_batch(const LightTreeView& tree, const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_name name;
    __builtin_memcpy(&name, batch.names + i * batch.name_stride, sizeof name);
    const float probability = split_pdf_of<N>(tree, batch, i, name);
    __builtin_memcpy(batch.answers + i * batch.answer_stride, &probability, sizeof probability);
  }
}

template <int N>
LightKernels light_kernels_of_width() {
  return {sample_batch<N>, pdf_batch<N>, split_batch<N>, split_pdf_batch<N>};
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
