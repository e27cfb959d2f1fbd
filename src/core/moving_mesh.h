// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry.h"
#include "kiwami/moving_mesh.h"
#include "wide/motion_part.h"

namespace kiwami {

/// A triangle mesh at several times: the caller's buffers, or tightly packed copies of them.
class MovingMesh final : public Geometry {
 public:
  /// Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static MovingMesh* create(Device& device, const kiwami_moving_mesh_desc& desc);

  MovingMesh(Device& device, const kiwami_moving_mesh_desc& desc);
  /// Over tightly packed buffers in a file, which it holds. Checks the indices unless they are
  /// trusted. Throws Error(INVALID_ARGUMENT).
  MovingMesh(Device& device, FileImage& image, const MovingMeshView& view, bool is_trusted);

  uint32_t triangle_count() const { return view_.triangle_count; }
  /// The buffers alone.
  const MovingMeshView& buffers() const { return view_; }
  size_t copied_bytes() const override { return vertices_.bytes() + indices_.bytes(); }

  /// The mesh as a part of a scene: its running ids begin at first_id.
  MovingMeshView view(uint32_t first_id, uint32_t geometry_id) const {
    MovingMeshView view = view_;
    view.first_id = first_id;
    view.geometry_id = geometry_id;
    view.mask = mask();
    return view;
  }

 private:
  void end(Memory& memory) noexcept override { destroy_object(memory, this); }
  void copy_buffers();

  Array<unsigned char> vertices_, indices_;
  MovingMeshView view_{};
};

}  // namespace kiwami
