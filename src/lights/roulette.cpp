// SPDX-License-Identifier: Apache-2.0
// The hierarchical Russian roulette of committed lights.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>

#include "lights/committed_lights.h"

namespace kiwami {
namespace {

/// Of the choices that there is room for, how many are aimed at: the number of accepted lights
/// varies.
constexpr double kAimedShare = 0.5;
constexpr double kGreatestRandom = 1.0 - 0x1p-53;

bool are_coordinates(const float (&a)[3]) {
  return std::fabs(a[0]) <= KIWAMI_MAX_COORDINATE && std::fabs(a[1]) <= KIWAMI_MAX_COORDINATE &&
         std::fabs(a[2]) <= KIWAMI_MAX_COORDINATE;
}

/// False for a receiver that gets no light. A segment is as its first point without a normal: every
/// light has a probability above 0.
bool read_receiver(const kiwami_light_receiver& receiver, RouletteReceiver& result) {
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
  result.counts_cosine = square > 0.0 && !has_segment;
  if (result.counts_cosine) {
    const double scale = 1.0 / std::sqrt(square);
    for (int axis = 0; axis < 3; ++axis) {
      const double normal = static_cast<double>(receiver.normal[axis]);
      result.normal[axis] = static_cast<float>(normal * scale);
    }
  }
  result.takes_both_sides = (receiver.flags & KIWAMI_RECEIVER_BOTH_SIDES) != 0;
  result.link_mask = receiver.link_mask;
  return true;
}

double clamped(double random) { return random > 0.0 ? std::min(random, kGreatestRandom) : 0.0; }

/// A random number for light number index: SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, "Fast
/// Splittable Pseudorandom Number Generators", OOPSLA 2014) over the receiver's bits.
uint64_t mixed(double random, uint64_t index) {
  uint64_t bits;
  std::memcpy(&bits, &random, sizeof bits);
  bits += (index + 1) * 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  return bits ^ (bits >> 31);
}
double number_of(uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

float above_zero(double probability) {
  return std::max(static_cast<float>(probability), std::numeric_limits<float>::min());
}

/// What is left for the tree where a distant light takes a choice.
double aimed_count(uint32_t max_count, bool has_distant) {
  return kAimedShare * (max_count - (has_distant && max_count > 1 ? 1 : 0));
}

}  // namespace

uint32_t CommittedLights::play_roulette(const kiwami_light_receiver& given,
                                        kiwami_light_choice* choices, uint32_t max_count) const {
  RouletteReceiver receiver;
  if (!read_receiver(given, receiver)) return 0;
  const double random = clamped(given.random);
  const bool has_distant = !distant_powers_.empty();
  uint32_t count = 0;
  if (has_distant) {
    const AliasTable::Draw draw = distant_powers_.draw(number_of(mixed(random, ~uint64_t{0})));
    const uint32_t id = distant_[draw.index].light_id;
    choices[count++] = {id, KIWAMI_INVALID_ID, user_ids_[id],
                        above_zero(distant_powers_.probability(draw.index)), draw.random};
  }
  const uint32_t first = count;
  const uint32_t room = max_count - first;
  const double strength = perfect_tree_.strength_for(receiver, aimed_count(max_count, has_distant));
  uint64_t accepted = 0;
  perfect_tree_.play(receiver, strength, random, [&](const AcceptedLeaf& leaf) {
    const uint64_t bits = mixed(random, leaf.leaf);
    // Where there is no more room, each that was accepted is as likely to stay (reservoir
    // sampling).
    uint64_t place = accepted++;
    if (place >= room) place = mixed(number_of(bits), leaf.leaf) % accepted;
    if (place >= room) return;
    kiwami_light_choice& choice = choices[first + place];
    if (leaf.leaf < view_.light_count) {
      choice = {leaf.leaf, KIWAMI_INVALID_ID, user_ids_[leaf.leaf], above_zero(leaf.probability),
                number_of(bits)};
      return;
    }
    const uint32_t instance = leaf.leaf - view_.light_count;
    const CommittedLights& inner = *held_[instance];
    const AliasTable::Draw draw = inner.leaf_powers_.draw(number_of(bits));
    choice = {draw.index, instance, inner.user_ids_[draw.index],
              above_zero(static_cast<double>(leaf.probability) *
                         inner.leaf_powers_.probability(draw.index)),
              draw.random};
  });
  count = first + static_cast<uint32_t>(std::min<uint64_t>(accepted, room));
  if (accepted > room) {
    const double share = static_cast<double>(room) / static_cast<double>(accepted);
    for (uint32_t i = first; i < count; ++i) {
      choices[i].probability = above_zero(static_cast<double>(choices[i].probability) * share);
    }
  }
  return count;
}

float CommittedLights::roulette_probability(const kiwami_light_receiver& given,
                                            const kiwami_light_name& name,
                                            uint32_t max_count) const {
  RouletteReceiver receiver;
  if (!read_receiver(given, receiver)) return 0.0f;
  const bool is_in_instance = name.instance_id != KIWAMI_INVALID_ID;
  if (is_in_instance ? name.instance_id >= held_.size() : name.light_id >= view_.light_count) {
    return 0.0f;
  }
  for (uint32_t i = 0; i < distant_.size() && !is_in_instance; ++i) {
    if (distant_[i].light_id != name.light_id) continue;
    const double probability = distant_powers_.empty() ? 0.0 : distant_powers_.probability(i);
    return probability > 0.0 ? above_zero(probability) : 0.0f;
  }
  const double strength =
      perfect_tree_.strength_for(receiver, aimed_count(max_count, !distant_powers_.empty()));
  const uint32_t leaf = is_in_instance ? view_.light_count + name.instance_id : name.light_id;
  const float probability = perfect_tree_.probability(receiver, strength, leaf);
  if (!(probability > 0.0f)) return 0.0f;
  if (!is_in_instance) return above_zero(probability);
  const CommittedLights& inner = *held_[name.instance_id];
  if (name.light_id >= inner.view_.light_count || inner.leaf_powers_.empty()) return 0.0f;
  const double own = inner.leaf_powers_.probability(name.light_id);
  return own > 0.0 ? above_zero(static_cast<double>(probability) * own) : 0.0f;
}

}  // namespace kiwami
