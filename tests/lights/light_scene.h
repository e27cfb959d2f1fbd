// SPDX-License-Identifier: Apache-2.0
// Lights and receivers to try, and what a light contributes, computed from its description in
// double precision: it shares no code with the library.
#pragma once

#include <memory>
#include <vector>

#include "kiwami/kiwami.h"
#include "support/random.h"

namespace kiwami_tests {

struct ReleaseLights {
  void operator()(kiwami_light_tree* tree) const { kiwami_light_tree_release(tree); }
};
using LightTreeHandle = std::unique_ptr<kiwami_light_tree, ReleaseLights>;

/// A light where it is seen: transformed, in an instance.
struct SeenLight {
  kiwami_light_name name;
  kiwami_light light;
  float local_to_world[12];
  uint64_t link_mask;  ///< its own and the instance's
  double power;        ///< the instance's scale included
};

struct LightScene {
  std::vector<kiwami_light> lights;
  struct Group {
    std::vector<kiwami_light> lights;
    kiwami_light_instance_desc instance;  ///< tree is set by make_tree
  };
  std::vector<Group> groups;

  std::vector<SeenLight> seen() const;
};

struct LightSceneOptions {
  uint32_t light_count = 100;
  uint32_t group_count = 0;
  uint32_t lights_per_group = 20;
  uint32_t distant_count = 0;
  bool has_link_masks = false;
};

/// Lights of all types, in clusters of several sizes, some without power.
LightScene random_light_scene(const LightSceneOptions& options, Random& random);

/// The scene, committed. options.width and builder as in kiwami_light_tree_desc.
LightTreeHandle make_light_tree(kiwami_device* device, const LightScene& scene, uint32_t width,
                                uint32_t builder = KIWAMI_LIGHT_BUILDER_SAOH);

/// A receiver on, in, near or far from the lights: with a normal, without, for both sides, or a
/// segment.
kiwami_light_receiver random_receiver(const LightScene& scene, Random& random);

/// What a light contributes to a receiver: the mean over some points of the light (and of a
/// segment), corners among them. 0 if the two are not linked.
double contribution(const SeenLight& seen, const kiwami_light_receiver& receiver);

}  // namespace kiwami_tests
