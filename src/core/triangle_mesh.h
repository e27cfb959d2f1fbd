// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/triangle_source.h"
#include "core/file_image.h"
#include "core/geometry.h"

namespace kiwami {

/// A triangle mesh: the caller's buffers, tightly packed copies of them, or buffers in a file.
class TriangleMesh final : public Geometry {
 public:
  /// Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static TriangleMesh* create(Device& device, const kiwami_triangle_mesh_desc& desc);

  TriangleMesh(Device& device, const kiwami_triangle_mesh_desc& desc);
  /// Over tightly packed buffers in a file, which it holds. Checks the indices unless they are
  /// trusted.
  TriangleMesh(Device& device, FileImage& image, const TriangleMeshView& view, bool is_trusted);

  uint32_t triangle_count() const { return view_.triangle_count; }
  size_t copied_bytes() const override { return vertices_.bytes() + indices_.bytes(); }

  /// The mesh as a part of a scene: its running ids begin at first_id.
  TriangleMeshView view(uint32_t first_id, uint32_t geometry_id) const {
    TriangleMeshView view = view_;
    view.first_id = first_id;
    view.geometry_id = geometry_id;
    view.mask = mask();
    return view;
  }

 private:
  void end(Memory& memory) noexcept override { destroy_object(memory, this); }
  void copy_buffers();
  void check_indices() const;

  Reference<FileImage> image_;
  Array<unsigned char> vertices_;
  Array<unsigned char> indices_;
  TriangleMeshView view_;
};

}  // namespace kiwami
