// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/committed_scene.h"
#include "core/device.h"
#include "core/object.h"
#include "kiwami/bvh.h"

namespace kiwami {

/// What a tree costs, and what each node adds to that.
struct BvhMeasures {
  kiwami_bvh_measures totals;
  Array<kiwami_bvh_node_measures> nodes;
};

/// A tree to look at: flat nodes, and the ids of the primitives in their order. Never changes.
class Bvh : public Object<Bvh> {
 public:
  /// The tree of a committed scene, which it holds for its triangles. Throws Error(TOO_LARGE or
  /// OUT_OF_MEMORY).
  static Bvh* create(Device& device, CommittedScene& scene);
  static void destroy(Bvh* bvh) noexcept;

  Bvh(Device& device, CommittedScene& scene);

  Device& device() const { return *device_; }
  const kiwami_bvh_info& info() const { return info_; }
  const Array<kiwami_bvh_node>& nodes() const { return nodes_; }
  size_t primitive_count() const { return primitive_ids_.size(); }
  kiwami_bvh_primitive primitive(size_t position) const;

  /// struct_size of the totals is 0. Throws Error(OUT_OF_MEMORY).
  BvhMeasures measure(const kiwami_bvh_measure_desc& desc) const;

 private:
  void describe(uint32_t width, uint32_t leaf_width);

  Reference<Device> device_;
  Reference<CommittedScene> scene_;
  TriangleSource source_;
  Array<kiwami_bvh_node> nodes_;
  Array<uint32_t> primitive_ids_;
  kiwami_bvh_info info_{};
};

}  // namespace kiwami
