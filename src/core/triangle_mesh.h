// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bvh/triangle_source.h"
#include "core/geometry.h"
#include "core/opacity_map.h"

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
  size_t copied_bytes() const override;
  BufferCopy* replaceable_buffer() const override { return vertices_.get(); }

  /// Takes other vertices, as many as there are. They are copied; shared ones are read there from
  /// now on, or, where vertices is nullptr, where they were. Throws Error(INVALID_ARGUMENT,
  /// OUT_OF_MEMORY or CALLBACK), and then nothing has changed.
  void update_vertices(const void* vertices, uint64_t offset, uint64_t stride);

  /// The mesh as a part of a scene: its running ids begin at first_id.
  TriangleMeshView view(uint32_t first_id, uint32_t geometry_id) const {
    TriangleMeshView view = view_;
    view.first_id = first_id;
    view.geometry_id = geometry_id;
    view.mask = mask();
    return view;
  }

  /// May be null. Scenes hold the one that they were committed with.
  OpacityMap* opacity() const { return opacity_.get(); }
  void set_opacity(Reference<OpacityMap> opacity) { opacity_ = std::move(opacity); }

 private:
  void end(Memory& memory) noexcept override { destroy_object(memory, this); }
  void copy_buffers();

  // None for shared vertices; those in a file are borrowed. The spare one takes the next vertices
  // if nobody holds it by then.
  Reference<BufferCopy> vertices_, spare_vertices_;
  Array<unsigned char> indices_;
  TriangleMeshView view_;
  bool shares_buffers_ = false;
  Reference<OpacityMap> opacity_;
};

}  // namespace kiwami
