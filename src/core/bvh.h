// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/committed_scene.h"
#include "core/device.h"
#include "core/object.h"
#include "kiwami/bvh.h"

namespace kiwami {

/// A tree to look at: flat nodes, and the names of the primitives in their order. Never changes.
class Bvh : public Object<Bvh> {
 public:
  /// The tree of a committed scene. Throws Error(TOO_LARGE or OUT_OF_MEMORY).
  static Bvh* create(Device& device, const CommittedScene& scene);
  static void destroy(Bvh* bvh) noexcept;

  Bvh(Device& device, const CommittedScene& scene);

  Device& device() const { return *device_; }
  const kiwami_bvh_info& info() const { return info_; }
  const Array<kiwami_bvh_node>& nodes() const { return nodes_; }
  const Array<kiwami_bvh_primitive>& primitives() const { return primitives_; }

 private:
  void describe(uint32_t width, uint32_t leaf_width);

  Reference<Device> device_;
  Array<kiwami_bvh_node> nodes_;
  Array<kiwami_bvh_primitive> primitives_;
  kiwami_bvh_info info_{};
};

}  // namespace kiwami
