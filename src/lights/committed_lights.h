// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/device.h"
#include "core/object.h"
#include "lights/wide_light_tree.h"

namespace kiwami {

class CommittedLights;

/// An instance as it was described. Who keeps one holds its lights.
struct LightInstance {
  CommittedLights* lights;
  float local_to_world[12];
  float power_scale;
  uint64_t link_mask;
};

/// What a set of lights is, for a tree over it. The arrays are the caller's.
struct LightInput {
  const LightRecord* lights;
  const uint32_t* user_ids;
  const LightInstance* instances;
  uint32_t light_count;
  uint32_t instance_count;
  uint32_t width;
  uint32_t builder;
  float distant_probability;
};

/// A tree over lights with all that kernels read, never changed again: so an instance shows the
/// tree that it was given, whatever becomes of the set.
class CommittedLights : public Object<CommittedLights> {
 public:
  /// Builds a tree. Throws Error(OUT_OF_MEMORY or CALLBACK).
  static CommittedLights* create(Device& device, const LightInput& input);
  /// The same lights, changed, in the shape of an earlier tree. Throws Error(INVALID_STATE) where
  /// the shape does not fit them.
  static CommittedLights* create(Device& device, const LightInput& input,
                                 const CommittedLights& shape);
  static void destroy(CommittedLights* lights) noexcept;

  CommittedLights(Device& device, const LightInput& input, const CommittedLights* shape);
  ~CommittedLights();

  Device& device() const { return *device_; }
  const LightTreeView& view() const { return view_; }
  const kiwami_light_tree_info& info() const { return info_; }
  uint32_t width() const { return tree_.width; }
  /// Of all lights in the tree together, as a leaf of another; light_count 0 where there is none.
  const InstanceLeaf& summary() const { return summary_; }

 private:
  void build(const LightInput& input, const LightLeaves& leaves, const CommittedLights* shape);
  void collect_distant(const LightInput& input);
  void place_instances(const LightInput& input, Array<InstanceLeaf>& leaves);
  void describe(const LightInput& input);

  Reference<Device> device_;
  LightLinks links_;
  WideLightTree tree_;
  Array<uint32_t> user_ids_;
  Array<DistantLightView> distant_;
  Array<LightInstanceView> instance_views_;
  /// The trees of instances, each held once per instance.
  Array<CommittedLights*> held_;
  InstanceLeaf summary_{};
  LightTreeView view_{};
  kiwami_light_tree_info info_{};
};

}  // namespace kiwami
