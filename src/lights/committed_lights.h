// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/device.h"
#include "core/object.h"
#include "lights/alias_table.h"
#include "lights/light_set.h"
#include "lights/perfect_light_tree.h"
#include "lights/wide_light_tree.h"

namespace kiwami {

/// A set of lights, and how a tree is built over it.
struct LightInput {
  LightSet& set;
  uint32_t width;
  uint32_t builder;
  float distant_probability;
  bool has_roulette;  ///< whether the tree for it is built, too

  uint32_t light_count() const { return static_cast<uint32_t>(set.lights.size()); }
  uint32_t instance_count() const { return static_cast<uint32_t>(set.instances.size()); }
};

/// The shape of a tree: which clusters there are, and which of them are the slots of which node.
struct LightShape {
  const LightLinks& links;
  const WideLightTree& tree;  ///< width, counts and slot_clusters alone
  uint32_t leaf_count;        ///< lights and instances
};

/// A tree over lights with all that kernels read, never changed again: so an instance shows the
/// tree that it was given, whatever becomes of the set.
class CommittedLights : public Object<CommittedLights> {
 public:
  /// Builds a tree. Throws Error(OUT_OF_MEMORY or CALLBACK).
  static CommittedLights* create(Device& device, const LightInput& input);
  /// The same lights, changed, in the shape of an earlier tree. Throws Error(INVALID_STATE) where
  /// the shape does not fit them.
  static CommittedLights* create(Device& device, const LightInput& input, const LightShape& shape);
  static void destroy(CommittedLights* lights) noexcept;

  CommittedLights(Device& device, const LightInput& input, const LightShape* shape);

  Device& device() const { return *device_; }
  /// What it was made of, unchanged since.
  const LightSet& set() const { return *set_; }
  LightShape shape() const { return {links_, tree_, info_.light_count + info_.instance_count}; }
  const LightTreeView& view() const { return view_; }
  const kiwami_light_tree_info& info() const { return info_; }
  /// Of a tree that was built before it was saved.
  void set_build_seconds(double seconds) { info_.build_seconds = seconds; }
  uint32_t width() const { return tree_.width; }
  /// Of all lights in the tree together, as a leaf of another; light_count 0 where there is none.
  const InstanceLeaf& summary() const { return summary_; }

  /// One choice by power alone, whatever the receiver is. Distant lights have the same share as
  /// with trees where the tree has lights.
  kiwami_light_choice choose_by_power(double random) const;
  double probability_by_power(const kiwami_light_name& name) const;

  /// Whether it was built with what the roulettes need.
  bool has_roulette() const { return has_roulette_; }
  /// The lights that the roulette accepts, and a distant one, at most rules.max_count; returns how
  /// many.
  uint32_t play_roulette(const kiwami_light_receiver& receiver, const RouletteExtras& extras,
                         const RouletteRules& rules, kiwami_light_choice* choices) const;
  /// The probability with which the roulette accepts a light. lobe may be null.
  float roulette_probability(const kiwami_light_receiver& receiver, const kiwami_light_lobe* lobe,
                             const RouletteRules& rules, const kiwami_light_name& name) const;

 private:
  const CommittedLights& instance(uint32_t number) const { return *set_->instances[number].lights; }
  void build(const LightInput& input, const LightLeaves& leaves, const LightShape* shape);
  void collect_distant(const LightInput& input);
  void place_instances(const LightInput& input, Array<InstanceLeaf>& leaves);
  void describe(const LightInput& input);
  void weigh(const LightInput& input, const LightLeaves& leaves);
  double distant_share() const;
  kiwami_light_choice choice_of_leaf(const AcceptedLeaf& leaf, double random) const;
  double roulette_strength(const RouletteReceiver& receiver, const RouletteRules& rules) const;

  Reference<Device> device_;
  Reference<LightSet> set_;
  LightLinks links_;
  WideLightTree tree_;
  Array<DistantLightView> distant_;
  Array<LightInstanceView> instance_views_;
  bool has_roulette_ = false;
  PerfectLightTree perfect_tree_;
  AliasTable leaf_powers_;     ///< of lights and instances
  AliasTable distant_powers_;  ///< by place in distant_
  InstanceLeaf summary_{};
  LightTreeView view_{};
  kiwami_light_tree_info info_{};
};

}  // namespace kiwami
