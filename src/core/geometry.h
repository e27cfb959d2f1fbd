// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/triangle_source.h"
#include "core/device.h"
#include "core/memory.h"
#include "core/object.h"
#include "kiwami/geometry.h"

namespace kiwami {

/// A triangle mesh: the caller's buffers, or tightly packed copies of them.
class TriangleMesh : public Object<TriangleMesh> {
 public:
  /// Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static TriangleMesh* create(Device& device, const kiwami_triangle_mesh_desc& desc);
  static void destroy(TriangleMesh* mesh) noexcept;

  TriangleMesh(Device& device, const kiwami_triangle_mesh_desc& desc);

  Device& device() const { return *device_; }
  uint32_t triangle_count() const { return view_.triangle_count; }
  uint32_t mask() const { return view_.mask; }
  /// The bytes of the copied buffers; 0 for shared ones.
  size_t copied_bytes() const { return vertices_.bytes() + indices_.bytes(); }

  /// The mesh as a part of a scene: its running ids begin at first_id.
  TriangleMeshView view(uint32_t first_id, uint32_t geometry_id) const {
    TriangleMeshView view = view_;
    view.first_id = first_id;
    view.geometry_id = geometry_id;
    return view;
  }

 private:
  void copy_buffers();
  void check_indices() const;

  Reference<Device> device_;
  Array<unsigned char> vertices_;
  Array<unsigned char> indices_;
  TriangleMeshView view_;
};

}  // namespace kiwami
