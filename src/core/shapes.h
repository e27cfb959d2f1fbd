// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry.h"
#include "kiwami/shapes.h"
#include "wide/shape_source.h"

namespace kiwami {

/// Spheres, discs or curve segments: the caller's buffers, or tightly packed copies of them.
class Shapes final : public Geometry {
 public:
  /// Throw Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static Shapes* create(Device& device, const kiwami_spheres_desc& desc);
  static Shapes* create(Device& device, const kiwami_discs_desc& desc);
  static Shapes* create(Device& device, const kiwami_curves_desc& desc);

  /// A buffer of the caller's.
  struct Buffer {
    const char* name;         ///< of its elements, for errors
    const char* stride_name;  ///< of the field
    const void* data;
    uint64_t offset, stride, count;
    size_t element_size;
  };
  /// Those of one geometry; a kind that has no normals or indices leaves them empty.
  struct Description {
    GeometryKind kind;
    uint64_t count;  ///< of shapes
    uint32_t flags, mask;
    Buffer points, normals, indices;
  };
  Shapes(Device& device, const Description& description);
  /// Over tightly packed buffers in a file, which it holds. Checks the indices unless they are
  /// trusted. Throws Error(INVALID_ARGUMENT).
  Shapes(Device& device, FileImage& image, GeometryKind kind, const ShapeView& view,
         bool is_trusted);

  uint32_t count() const { return view_.count; }
  /// The buffers alone.
  const ShapeView& buffers() const { return view_; }
  size_t copied_bytes() const override {
    return points_.bytes() + normals_.bytes() + indices_.bytes();
  }

  /// The shapes as a part of a scene: their running ids begin at first_id.
  ShapeView view(uint32_t first_id, uint32_t geometry_id) const {
    ShapeView view = view_;
    view.first_id = first_id;
    view.geometry_id = geometry_id;
    view.mask = mask();
    return view;
  }

 private:
  void end(Memory& memory) noexcept override { destroy_object(memory, this); }
  void copy_buffers();
  void check_indices() const;

  Array<unsigned char> points_, normals_, indices_;
  ShapeView view_{};
};

}  // namespace kiwami
