// SPDX-License-Identifier: Apache-2.0
// The opacity micromaps of a mesh.
#pragma once

#include "core/device.h"
#include "core/memory.h"
#include "core/object.h"
#include "kiwami/opacity.h"
#include "wide/wide_bvh.h"

namespace kiwami {

/// Copies of the caller's maps. Never changes, so that scenes can hold it while its mesh gets
/// another.
class OpacityMap : public Object<OpacityMap> {
 public:
  /// Of a mesh of so many triangles. Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static Reference<OpacityMap> create(Device& device, const kiwami_opacity_desc& desc,
                                      uint32_t triangle_count);
  static void destroy(OpacityMap* map) noexcept;

  OpacityMap(Device& device, const kiwami_opacity_desc& desc, uint32_t triangle_count);

  const OpacityView& view() const { return view_; }

 private:
  void copy_indices(const kiwami_opacity_desc& desc, uint32_t triangle_count);

  Reference<Device> device_;
  Array<unsigned char> maps_;
  Array<uint32_t> indices_;
  OpacityView view_{};
};

}  // namespace kiwami
