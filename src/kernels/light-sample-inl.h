// SPDX-License-Identifier: Apache-2.0
// Choosing a light from a tree: down from the root, one child of N at a time, in proportion to
// their importances, with one random number that is stretched anew at each node (Conty Estevez &
// Kulla 2018; N at once: S. Ogaki, "Acceleration Data Structures for Ray Tracing", CEDEC 2019).
//
// Departures: sums are made one slot after the other in double precision, so that no slot is lost
// beside a larger one and every ISA has the same sums; where a node turns out to hold nothing that
// can contribute although it seemed to, its lights are chosen by their energy, so that
// probabilities always sum to 1; the way to a light is found from the light upwards, by the slots
// that refer to its ancestors, so that no bit trail limits the depth.
#pragma once

#include "kernels/light-importance-inl.h"
#include "kernels/light_kernels.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

constexpr double kGreatestRandom = 1.0 - 0x1p-53;

/// How the children of a node share its probability.
template <int N>
struct LightShares {
  float importance[N];
  float bound[N];  ///< of what a child contributes at most; of lightcuts alone
  double sum[N];   ///< of the slots up to this one

  double total() const { return sum[N - 1]; }
};

template <int N>
inline const LightNode<N>& node_of(const LightTreeView& tree, uint32_t index) {
  return static_cast<const LightNode<N>*>(tree.nodes)[index];
}

/// Leaves out what is not linked, and sums.
template <int N>
inline void sum_up(const LightNode<N>& node, uint64_t link_mask, LightShares<N>& shares) {
  if (link_mask != ~uint64_t{0}) {
    for (int i = 0; i < N; ++i) {
      if ((node.link_mask[i] & link_mask) == 0) shares.importance[i] = 0.0f;
    }
  }
  double sum = 0.0;
  for (int i = 0; i < N; ++i) {
    sum += static_cast<double>(shares.importance[i]);
    shares.sum[i] = sum;
  }
}

/// The importances by which stochastic lightcuts choose: the mean of the shares by the nearest and
/// by the farthest points. Nothing is known of a segment but its importance.
template <int N>
inline void store_lightcut(const LightTreeView& tree, const LightNode<N>& node,
                           const LightPoint& point, LightShares<N>& shares) {
  vfloat<N> near, far;
  lightcut_terms(node, point, tree.least_square, near, far);
  float far_terms[N];
  store(shares.bound, near);
  store(far_terms, far);
  double near_total = 0.0, far_total = 0.0;
  for (int i = 0; i < N; ++i) {
    // What is not linked must not take part in the totals.
    if ((node.link_mask[i] & point.link_mask) == 0) shares.bound[i] = far_terms[i] = 0.0f;
    near_total += static_cast<double>(shares.bound[i]);
    far_total += static_cast<double>(far_terms[i]);
  }
  for (int i = 0; i < N; ++i) {
    shares.importance[i] = 0.0f;
    if (!(shares.bound[i] > 0.0f)) continue;
    const double mean = static_cast<double>(shares.bound[i]) / near_total +
                        static_cast<double>(far_terms[i]) / far_total;
    const float importance = static_cast<float>(mean);
    shares.importance[i] = importance > kLeastImportance ? importance : kLeastImportance;
  }
}

/// The shares of a node by importance; all 0 where nothing can contribute.
template <int N>
inline void share_by_importance(const LightTreeView& tree, const LightNode<N>& node,
                                const LightPoint& point, LightShares<N>& shares) {
  if (point.is_lightcut && !point.has_segment) {
    store_lightcut(tree, node, point, shares);
    return sum_up(node, point.link_mask, shares);
  }
  const vfloat<N> importance = point.has_segment
                                   ? importance_along_segment(node, point, tree.least_square)
                                   : importance_at_point(node, point, tree.least_square);
  store(shares.importance, importance);
  store(shares.bound, importance);
  sum_up(node, point.link_mask, shares);
}

/// The same; by energy where nothing can contribute.
template <int N>
inline void share(const LightTreeView& tree, const LightNode<N>& node, const LightPoint& point,
                  LightShares<N>& shares) {
  share_by_importance(tree, node, point, shares);
  if (shares.total() > 0.0) return;
  for (int i = 0; i < N; ++i) shares.importance[i] = node.energy[i];
  sum_up(node, point.link_mask, shares);
}

/// Chooses a slot of shares, whose total is not 0, and stretches random.
template <int N>
inline uint32_t choose_slot(const LightShares<N>& shares, double& random, double& probability) {
  const double total = shares.total();
  const double target = random * total;
  int slot = 0;
  for (int i = 0; i < N; ++i) slot += shares.sum[i] <= target ? 1 : 0;
  // target rounded up to the total: the last slot that has a share.
  if (slot == N) --slot;
  while (!(shares.importance[slot] > 0.0f)) --slot;
  const double importance = static_cast<double>(shares.importance[slot]);
  const double before = slot == 0 ? 0.0 : shares.sum[slot - 1];
  const double stretched = (target - before) / importance;
  random = stretched < 0.0 ? 0.0 : stretched > kGreatestRandom ? kGreatestRandom : stretched;
  probability *= importance / total;
  return static_cast<uint32_t>(slot);
}

inline bool is_finite(float a) { return a - a == 0.0f; }
inline bool are_finite(const float (&a)[3]) {
  return is_finite(a[0]) && is_finite(a[1]) && is_finite(a[2]);
}
inline bool are_coordinates(const float (&a)[3]) {
  return __builtin_fabsf(a[0]) <= KIWAMI_MAX_COORDINATE &&
         __builtin_fabsf(a[1]) <= KIWAMI_MAX_COORDINATE &&
         __builtin_fabsf(a[2]) <= KIWAMI_MAX_COORDINATE;
}

/// Makes the length 1; false where it is 0. In double, where no square of a float overflows.
inline bool normalise(float (&a)[3]) {
  const double x = static_cast<double>(a[0]), y = static_cast<double>(a[1]),
               z = static_cast<double>(a[2]);
  const double square = x * x + y * y + z * z;
  if (!(square > 0.0)) return false;
  const double scale = 1.0 / __builtin_sqrt(square);
  a[0] = static_cast<float>(x * scale);
  a[1] = static_cast<float>(y * scale);
  a[2] = static_cast<float>(z * scale);
  return true;
}

/// The lobe of a receiver; one without a direction is as if there were none. By the same numbers as
/// that of the roulettes.
inline void read_lobe(const kiwami_light_lobe& lobe, LightPoint& point) {
  for (int i = 0; i < 3; ++i) point.lobe_axis[i] = lobe.axis[i];
  if (!are_finite(lobe.axis) || !normalise(point.lobe_axis)) return;
  const double given = static_cast<double>(lobe.roughness);
  // Not a number counts as 1.
  const double alpha = given < 1.0 ? given > 1e-3 ? given : 1e-3 : 1.0;
  const double square = alpha * alpha;
  point.lobe_eccentricity = static_cast<float>((1.0 - square) / (1.0 + square));
  point.lobe_least = static_cast<float>(2.0 * square / (1.0 + square));
  point.has_lobe = true;
}

/// A receiver of a batch, its lobe and all; false for one that gets no light.
inline bool read_receiver(const LightBatch& batch, size_t number, kiwami_light_receiver& receiver,
                          LightPoint& point) {
  __builtin_memcpy(&receiver, batch.receivers + number * batch.receiver_stride, sizeof receiver);
  if (!are_coordinates(receiver.position)) return false;
  if (!are_finite(receiver.normal) || !are_finite(receiver.segment)) return false;
  float end[3];
  bool has_segment = false;
  for (int i = 0; i < 3; ++i) {
    point.position[i] = receiver.position[i];
    point.normal[i] = receiver.normal[i];
    point.segment[i] = receiver.segment[i];
    end[i] = receiver.position[i] + receiver.segment[i];
    has_segment = has_segment || receiver.segment[i] != 0.0f;
  }
  point.slack = 0.0f;
  point.is_lightcut = batch.is_lightcut;
  point.has_segment = has_segment;
  point.has_lobe = false;
  if (batch.lobes && !has_segment) {
    kiwami_light_lobe lobe;
    __builtin_memcpy(&lobe, batch.lobes + number * batch.lobe_stride, sizeof lobe);
    read_lobe(lobe, point);
  }
  point.has_normal = normalise(point.normal) && !has_segment;
  point.takes_both_sides = (receiver.flags & KIWAMI_RECEIVER_BOTH_SIDES) != 0;
  point.link_mask = receiver.link_mask;
  return are_coordinates(end);
}

/// A receiver in the coordinates of an instance's tree. What is above a plane stays above it.
inline LightPoint transformed(const LightPoint& point, const LightInstanceView& instance) {
  LightPoint local = point;
  local.link_mask = point.link_mask & instance.link_mask;
  for (int i = 0; i < 3; ++i) {
    const float(&row)[4] = instance.world_to_local[i];
    const float(&normal_row)[3] = instance.normal_to_local[i];
    const float x = row[0] * point.position[0], y = row[1] * point.position[1],
                z = row[2] * point.position[2];
    local.position[i] = x + y + z + row[3];
    const float size =
        __builtin_fabsf(x) + __builtin_fabsf(y) + __builtin_fabsf(z) + __builtin_fabsf(row[3]);
    // Rounding of four products and their sum, along each axis.
    local.slack += 4e-7f * size;
    local.segment[i] =
        row[0] * point.segment[0] + row[1] * point.segment[1] + row[2] * point.segment[2];
    local.normal[i] = normal_row[0] * point.normal[0] + normal_row[1] * point.normal[1] +
                      normal_row[2] * point.normal[2];
    if (point.has_lobe) {
      local.lobe_axis[i] =
          row[0] * point.lobe_axis[0] + row[1] * point.lobe_axis[1] + row[2] * point.lobe_axis[2];
    }
  }
  if (point.has_normal) local.has_normal = normalise(local.normal);
  if (point.has_lobe) local.has_lobe = normalise(local.lobe_axis);
  return local;
}

/// The greatest cosine between a direction and those to a distant light.
inline float cosine_to_distant(const DistantLightView& light, float cosine) {
  if (cosine >= light.cos_spread) return 1.0f;
  const float square = (1.0f - cosine) * (1.0f + cosine);
  const float sine = square > 0.0f ? __builtin_sqrtf(square) : 0.0f;
  return cosine * light.cos_spread + sine * light.sin_spread;
}

inline float dot_with(const DistantLightView& light, const float (&direction)[3]) {
  return light.direction[0] * direction[0] + light.direction[1] * direction[1] +
         light.direction[2] * direction[2];
}

/// What a distant light or an environment can contribute.
inline float distant_importance(const DistantLightView& light, const LightPoint& point) {
  if ((light.link_mask & point.link_mask) == 0) return 0.0f;
  const bool is_environment =
      light.direction[0] == 0.0f && light.direction[1] == 0.0f && light.direction[2] == 0.0f;
  if (is_environment) return light.energy;
  float factor = 1.0f;
  if (point.has_normal) {
    const float cosine = dot_with(light, point.normal);
    const float greatest =
        cosine_to_distant(light, point.takes_both_sides ? __builtin_fabsf(cosine) : cosine);
    if (greatest < -kPointCosineSlack) return 0.0f;
    factor = greatest > 0.0f ? greatest : 0.0f;
  }
  if (point.has_lobe) {
    const float away = 1.0f - cosine_to_distant(light, dot_with(light, point.lobe_axis));
    const float radius = point.lobe_least /
                         (point.lobe_least + point.lobe_eccentricity * (away > 0.0f ? away : 0.0f));
    factor = radius * radius;
  }
  const float importance = light.energy * factor;
  const float least = light.energy < kLeastImportance ? light.energy : kLeastImportance;
  return importance > least ? importance : least;
}

inline double total_distant_importance(const LightTreeView& tree, const LightPoint& point) {
  double total = 0.0;
  for (uint32_t i = 0; i < tree.distant_count; ++i) {
    total += static_cast<double>(distant_importance(tree.distant[i], point));
  }
  return total;
}

/// With which probability distant lights are chosen: certain or impossible where the others or they
/// cannot contribute.
inline double distant_share(const LightTreeView& tree, double distant_total, double tree_total) {
  if (!(distant_total > 0.0)) return 0.0;
  return tree_total > 0.0 ? tree.distant_probability : 1.0;
}

/// A probability as it is returned: above 0.
inline float returned_probability(double probability) {
  const float rounded = static_cast<float>(probability);
  return rounded > kLeastImportance ? rounded : kLeastImportance;
}

struct LightPath {
  uint32_t leaf;
  double probability;
  double random;
};

/// Goes down from a node to a leaf. The shares are those of the node, whose total is not 0.
template <int N>
inline void descend(const LightTreeView& tree, const LightPoint& point, uint32_t node,
                    LightShares<N>& shares, LightPath& path) {
  for (;;) {
    const uint32_t slot = choose_slot(shares, path.random, path.probability);
    const uint32_t child = node_of<N>(tree, node).child[slot];
    if (child & kLightLeafBit) {
      path.leaf = child & ~kLightLeafBit;
      return;
    }
    node = child;
    share(tree, node_of<N>(tree, node), point, shares);
  }
}

inline void write_none(kiwami_light_choice& choice) {
  choice = {KIWAMI_INVALID_ID, KIWAMI_INVALID_ID, 0, 0.0f, 0.0};
}

/// Chooses among the distant lights, whose total importance is not 0.
inline void choose_distant(const LightTreeView& tree, const LightPoint& point, double total,
                           double probability, double random, kiwami_light_choice& choice) {
  const double target = random * total;
  double sum = 0.0;
  uint32_t chosen = 0;
  double before = 0.0, importance = 0.0;
  for (uint32_t i = 0; i < tree.distant_count; ++i) {
    const double own = static_cast<double>(distant_importance(tree.distant[i], point));
    // The last one that has a share, if none is beyond the target.
    if (own > 0.0) {
      chosen = i;
      before = sum;
      importance = own;
    }
    sum += own;
    if (sum > target) break;
  }
  const double stretched = (target - before) / importance;
  const DistantLightView& light = tree.distant[chosen];
  choice = {light.light_id, KIWAMI_INVALID_ID, tree.user_ids[light.light_id],
            returned_probability(probability * (importance / total)),
            stretched < 0.0               ? 0.0
            : stretched > kGreatestRandom ? kGreatestRandom
                                          : stretched};
}

/// Turns the path to a leaf into a choice: goes on into an instance's tree.
template <int N>
inline void finish(const LightTreeView& tree, const LightPoint& point, LightShares<N>& shares,
                   LightPath& path, kiwami_light_choice& choice) {
  if (path.leaf < tree.light_count) {
    choice = {path.leaf, KIWAMI_INVALID_ID, tree.user_ids[path.leaf],
              returned_probability(path.probability), path.random};
    return;
  }
  const uint32_t instance_id = path.leaf - tree.light_count;
  const LightInstanceView& instance = tree.instances[instance_id];
  const LightPoint local = transformed(point, instance);
  share(instance.tree, node_of<N>(instance.tree, 0), local, shares);
  if (!(shares.total() > 0.0)) return write_none(choice);
  descend(instance.tree, local, 0, shares, path);
  choice = {path.leaf, instance_id, instance.tree.user_ids[path.leaf],
            returned_probability(path.probability), path.random};
}

template <int N>
inline void sample_one(const LightTreeView& tree, const LightBatch& batch, size_t i,
                       kiwami_light_choice& choice) {
  write_none(choice);
  kiwami_light_receiver receiver;
  LightPoint point;
  if (!read_receiver(batch, i, receiver, point)) return;
  LightShares<N> shares;
  double total = 0.0;
  if (tree.node_count != 0) {
    share_by_importance(tree, node_of<N>(tree, 0), point, shares);
    total = shares.total();
  }
  const double distant_total = total_distant_importance(tree, point);
  const double distant = distant_share(tree, distant_total, total);
  double random = receiver.random > 0.0 ? receiver.random : 0.0;
  if (random > kGreatestRandom) random = kGreatestRandom;
  if (random < distant) {
    return choose_distant(tree, point, distant_total, distant, random / distant, choice);
  }
  if (!(total > 0.0)) return;
  const double rest = 1.0 - distant;
  const double stretched = (random - distant) / rest;
  LightPath path{0, rest, stretched > kGreatestRandom ? kGreatestRandom : stretched};
  descend(tree, point, 0, shares, path);
  finish(tree, point, shares, path, choice);
}

/// Multiplies probability by the shares on the way from a node to a leaf, in that order; 0 for a
/// leaf that is not below it. by_energy: whether the node is shared by energy if nothing can
/// contribute: all but the root of the whole tree are.
template <int N>
inline double path_probability(const LightTreeView& tree, const LightPoint& point, uint32_t top,
                               uint32_t leaf, bool by_energy, double probability) {
  uint32_t slots[kMaxLightDepth];
  uint32_t depth = 0;
  uint32_t slot = tree.leaf_slots[leaf];
  for (;;) {
    if (slot == kNoLightSlot) return 0.0;
    slots[depth++] = slot;
    if (slot / N == top) break;
    slot = tree.parent_slots[slot / N];
  }
  LightShares<N> shares;
  while (depth-- != 0) {
    const LightNode<N>& node = node_of<N>(tree, slots[depth] / N);
    if (slots[depth] / N == top && !by_energy) {
      share_by_importance(tree, node, point, shares);
    } else {
      share(tree, node, point, shares);
    }
    const float importance = shares.importance[slots[depth] % N];
    if (!(importance > 0.0f)) return 0.0;
    probability *= static_cast<double>(importance) / shares.total();
  }
  return probability;
}

inline bool is_name_of_light(const LightTreeView& tree, const kiwami_light_name& name) {
  if (name.instance_id == KIWAMI_INVALID_ID) return name.light_id < tree.light_count;
  return name.instance_id < tree.instance_count &&
         name.light_id < tree.instances[name.instance_id].tree.light_count;
}

/// The share that a distant light has of all of them, whose total is not 0; 0 for others.
inline double share_of_distant(const LightTreeView& tree, const LightPoint& point,
                               const kiwami_light_name& name, double total) {
  if (name.instance_id != KIWAMI_INVALID_ID) return 0.0;
  for (uint32_t i = 0; i < tree.distant_count; ++i) {
    if (tree.distant[i].light_id != name.light_id) continue;
    return static_cast<double>(distant_importance(tree.distant[i], point)) / total;
  }
  return 0.0;
}

/// The probability of a light of the tree below a node of the outer tree (or below one of its
/// leaves, where top is that).
template <int N>
inline double tree_pdf(const LightTreeView& tree, const LightPoint& point, uint32_t top,
                       bool by_energy, const kiwami_light_name& name, double probability) {
  const bool is_in_instance = name.instance_id != KIWAMI_INVALID_ID;
  const uint32_t leaf = is_in_instance ? tree.light_count + name.instance_id : name.light_id;
  if (top & kLightLeafBit) {
    if (leaf != (top & ~kLightLeafBit)) return 0.0;
  } else {
    probability = path_probability<N>(tree, point, top, leaf, by_energy, probability);
  }
  if (!is_in_instance || !(probability > 0.0)) return probability;
  const LightInstanceView& instance = tree.instances[name.instance_id];
  return path_probability<N>(instance.tree, transformed(point, instance), 0, name.light_id, true,
                             probability);
}

template <int N>
inline float pdf_of(const LightTreeView& tree, const LightBatch& batch, size_t i,
                    const kiwami_light_name& name) {
  kiwami_light_receiver receiver;
  LightPoint point;
  if (!read_receiver(batch, i, receiver, point) || !is_name_of_light(tree, name)) return 0.0f;
  const double distant_total = total_distant_importance(tree, point);
  double distant = 0.0;
  if (distant_total > 0.0) {
    LightShares<N> shares;
    double total = 0.0;
    if (tree.node_count != 0) {
      share_by_importance(tree, node_of<N>(tree, 0), point, shares);
      total = shares.total();
    }
    distant = distant_share(tree, distant_total, total);
    const double own = share_of_distant(tree, point, name, distant_total);
    if (own > 0.0) return returned_probability(distant * own);
  }
  if (tree.node_count == 0 || !(distant < 1.0)) return 0.0f;
  const double probability = tree_pdf<N>(tree, point, 0, false, name, 1.0 - distant);
  return probability > 0.0 ? returned_probability(probability) : 0.0f;
}

template <int N>
void sample_batch(const LightTreeView& tree, const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_choice choice;
    sample_one<N>(tree, batch, i, choice);
    __builtin_memcpy(batch.answers + i * batch.answer_stride, &choice, sizeof choice);
  }
}

template <int N>
void pdf_batch(const LightTreeView& tree, const LightBatch& batch) {
  for (size_t i = 0; i < batch.count; ++i) {
    kiwami_light_name name;
    __builtin_memcpy(&name, batch.names + i * batch.name_stride, sizeof name);
    const float probability = pdf_of<N>(tree, batch, i, name);
    __builtin_memcpy(batch.answers + i * batch.answer_stride, &probability, sizeof probability);
  }
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
