// SPDX-License-Identifier: Apache-2.0
// The hierarchical Russian roulette of committed lights.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "lights/blue_noise.h"
#include "lights/committed_lights.h"

namespace kiwami {
namespace {

/// Of the choices that there is room for, how many are aimed at: the number of accepted lights
/// varies.
constexpr double kAimedShare = 0.5;
constexpr double kLeastRoughness = 1e-3;
constexpr double kGreatestRandom = 1.0 - 0x1p-53;

bool are_coordinates(const float (&a)[3]) {
  return std::fabs(a[0]) <= KIWAMI_MAX_COORDINATE && std::fabs(a[1]) <= KIWAMI_MAX_COORDINATE &&
         std::fabs(a[2]) <= KIWAMI_MAX_COORDINATE;
}

/// The ellipsoid of a GGX lobe: its distribution over mirrored directions at normal incidence is,
/// to a factor, 1 / (1 - e cos)^2 with e = (1 - alpha^2) / (1 + alpha^2).
void read_lobe(const kiwami_light_lobe& lobe, RouletteReceiver& result) {
  double square = 0.0;
  for (const float along : lobe.axis) {
    square += static_cast<double>(along) * static_cast<double>(along);
  }
  if (!(square > 0.0) || !std::isfinite(square)) return;
  const double scale = 1.0 / std::sqrt(square);
  for (int axis = 0; axis < 3; ++axis) {
    result.axis[axis] = static_cast<float>(static_cast<double>(lobe.axis[axis]) * scale);
  }
  // Not a number counts as 1.
  const double given = static_cast<double>(lobe.roughness);
  const double alpha = given < 1.0 ? std::max(given, kLeastRoughness) : 1.0;
  result.eccentricity = (1.0 - alpha * alpha) / (1.0 + alpha * alpha);
  result.lobe = RouletteLobe::kEllipsoid;
}

/// False for a receiver that gets no light. A segment is as its first point without a normal: every
/// light has a probability above 0.
bool read_receiver(const kiwami_light_receiver& receiver, const kiwami_light_lobe* lobe,
                   const RouletteRules& rules, RouletteReceiver& result) {
  if (!are_coordinates(receiver.position)) return false;
  result = {};
  bool has_segment = false;
  double square = 0.0;
  for (int axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(receiver.normal[axis]) || !std::isfinite(receiver.segment[axis])) {
      return false;
    }
    if (!(std::fabs(receiver.position[axis] + receiver.segment[axis]) <= KIWAMI_MAX_COORDINATE)) {
      return false;
    }
    has_segment = has_segment || receiver.segment[axis] != 0.0f;
    const double normal = static_cast<double>(receiver.normal[axis]);
    square += normal * normal;
    result.position[axis] = receiver.position[axis];
  }
  result.has_normal = square > 0.0 && !has_segment;
  if (result.has_normal) {
    const double scale = 1.0 / std::sqrt(square);
    for (int axis = 0; axis < 3; ++axis) {
      const double normal = static_cast<double>(receiver.normal[axis]);
      result.normal[axis] = static_cast<float>(normal * scale);
    }
  }
  result.takes_both_sides = (receiver.flags & KIWAMI_RECEIVER_BOTH_SIDES) != 0;
  result.link_mask = receiver.link_mask;
  result.lobe = RouletteLobe::kCosine;
  if (rules.method == KIWAMI_LIGHT_METHOD_CULLING) {
    result.lobe = RouletteLobe::kSphere;
  } else if (rules.lobe == KIWAMI_LIGHT_LOBE_TANGENT_SPHERE) {
    result.lobe = RouletteLobe::kTangentSphere;
  } else if (rules.lobe == KIWAMI_LIGHT_LOBE_GLOSSY && lobe && !has_segment) {
    read_lobe(*lobe, result);
  }
  return true;
}

double clamped(double random) { return random > 0.0 ? std::min(random, kGreatestRandom) : 0.0; }

float above_zero(double probability) {
  return std::max(static_cast<float>(probability), std::numeric_limits<float>::min());
}

/// What is left for the tree where a distant light takes a choice.
double aimed_count(uint32_t max_count, bool has_distant) {
  return kAimedShare * (max_count - (has_distant && max_count > 1 ? 1 : 0));
}

/// Plays with the numbers that the rules ask for.
template <typename Accept>
void play_by_rules(const PerfectLightTree& tree, const RouletteReceiver& receiver, double strength,
                   double random, const kiwami_light_pixel* pixel, const RouletteRules& rules,
                   const Accept& accept) {
  const auto play = [&](const auto& numbers) { tree.play(receiver, strength, numbers, accept); };
  const uint32_t levels = tree.level_count();
  const bool is_dithered = rules.sequence == KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE && pixel;
  const DitheredSource source(is_dithered ? *pixel : kiwami_light_pixel{}, rules.sequence_seed);
  if (rules.method == KIWAMI_LIGHT_METHOD_LAZY_ROULETTE) {
    const double number = is_dithered ? number_of_bits(source.bits(kFirstNumber)) : random;
    play(LazyNumbers(number, levels, rules.order == KIWAMI_LIGHT_ORDER_SCRAMBLED));
  } else if (is_dithered && rules.method == KIWAMI_LIGHT_METHOD_ROULETTE) {
    play(IndependentNumbersOf<DitheredSource>(source, levels));
  } else {
    play(IndependentNumbers(random, levels));
  }
}

}  // namespace

double CommittedLights::roulette_strength(const RouletteReceiver& receiver,
                                          const RouletteRules& rules) const {
  const double count = aimed_count(rules.max_count, !distant_powers_.empty());
  if (rules.method == KIWAMI_LIGHT_METHOD_CULLING) {
    return perfect_tree_.strength_of_reach(rules.reach, count);
  }
  return perfect_tree_.strength_for(receiver, count);
}

uint32_t CommittedLights::play_roulette(const kiwami_light_receiver& given,
                                        const RouletteExtras& extras, const RouletteRules& rules,
                                        kiwami_light_choice* choices) const {
  RouletteReceiver receiver;
  if (!read_receiver(given, extras.lobe, rules, receiver)) return 0;
  const double random = clamped(given.random);
  uint32_t first = 0;
  if (!distant_powers_.empty()) {
    const AliasTable::Draw draw =
        distant_powers_.draw(number_of_bits(mixed_bits(random, ~uint64_t{0})));
    const uint32_t id = distant_[draw.index].light_id;
    choices[first++] = {id, KIWAMI_INVALID_ID, set_->user_ids[id],
                        above_zero(distant_powers_.probability(draw.index)), draw.random};
  }
  const uint32_t room = rules.max_count - first;
  const double strength = roulette_strength(receiver, rules);
  uint64_t accepted = 0;
  const auto accept = [&](const AcceptedLeaf& leaf) {
    const uint64_t bits = mixed_bits(random, leaf.leaf);
    // Where there is no more room, each that was accepted is as likely to stay (reservoir
    // sampling).
    uint64_t place = accepted++;
    if (place >= room) place = mixed_bits(number_of_bits(bits), leaf.leaf) % accepted;
    if (place < room) choices[first + place] = choice_of_leaf(leaf, number_of_bits(bits));
  };
  play_by_rules(perfect_tree_, receiver, strength, random, extras.pixel, rules, accept);
  const uint32_t count = first + static_cast<uint32_t>(std::min<uint64_t>(accepted, room));
  if (accepted > room) {
    const double share = static_cast<double>(room) / static_cast<double>(accepted);
    for (uint32_t i = first; i < count; ++i) {
      choices[i].probability = above_zero(static_cast<double>(choices[i].probability) * share);
    }
  }
  return count;
}

kiwami_light_choice CommittedLights::choice_of_leaf(const AcceptedLeaf& leaf, double random) const {
  if (leaf.leaf < view_.light_count) {
    return {leaf.leaf, KIWAMI_INVALID_ID, set_->user_ids[leaf.leaf],
            above_zero(static_cast<double>(leaf.probability)), random};
  }
  const uint32_t instance = leaf.leaf - view_.light_count;
  const CommittedLights& inner = this->instance(instance);
  const AliasTable::Draw draw = inner.leaf_powers_.draw(random);
  const double own = inner.leaf_powers_.probability(draw.index);
  return {draw.index, instance, inner.set_->user_ids[draw.index],
          above_zero(static_cast<double>(leaf.probability) * own), draw.random};
}

float CommittedLights::roulette_probability(const kiwami_light_receiver& given,
                                            const kiwami_light_lobe* lobe,
                                            const RouletteRules& rules,
                                            const kiwami_light_name& name) const {
  RouletteReceiver receiver;
  if (!read_receiver(given, lobe, rules, receiver)) return 0.0f;
  const bool is_in_instance = name.instance_id != KIWAMI_INVALID_ID;
  if (is_in_instance ? name.instance_id >= view_.instance_count
                     : name.light_id >= view_.light_count) {
    return 0.0f;
  }
  for (uint32_t i = 0; i < distant_.size() && !is_in_instance; ++i) {
    if (distant_[i].light_id != name.light_id) continue;
    const double probability = distant_powers_.empty() ? 0.0 : distant_powers_.probability(i);
    return probability > 0.0 ? above_zero(probability) : 0.0f;
  }
  const double strength = roulette_strength(receiver, rules);
  const uint32_t leaf = is_in_instance ? view_.light_count + name.instance_id : name.light_id;
  const float probability = perfect_tree_.probability(receiver, strength, leaf);
  if (!(probability > 0.0f)) return 0.0f;
  if (!is_in_instance) return above_zero(probability);
  const CommittedLights& inner = instance(name.instance_id);
  if (name.light_id >= inner.view_.light_count || inner.leaf_powers_.empty()) return 0.0f;
  const double own = inner.leaf_powers_.probability(name.light_id);
  return own > 0.0 ? above_zero(static_cast<double>(probability) * own) : 0.0f;
}

}  // namespace kiwami
