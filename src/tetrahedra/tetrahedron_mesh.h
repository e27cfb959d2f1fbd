// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/device.h"
#include "core/object.h"
#include "kiwami/tetrahedra.h"
#include "tetrahedra/face_tracer.h"
#include "tetrahedra/tetrahedron_tree.h"

namespace kiwami {

/// The caller's buffers, checked as such.
struct TetrahedronInput {
  uint32_t method;
  const unsigned char* vertices;
  size_t vertex_stride, vertex_count;
  const unsigned char* indices;
  size_t index_stride, tetrahedron_count;
};

/// Strided points in, locations out.
struct LocationBatch {
  const unsigned char* points;
  size_t point_stride;
  unsigned char* locations;
  size_t location_stride;
  size_t count;
};

/// A tetrahedral mesh in which points are located. Never changed again.
class TetrahedronMesh : public Object<TetrahedronMesh> {
 public:
  static constexpr uint64_t kMaxVertexCount = 0xFFFFFFFE;
  static constexpr uint64_t kMaxTetrahedronCount = uint64_t{1} << 28;

  /// Throws Error(INVALID_ARGUMENT) that names a tetrahedron, Error(OUT_OF_MEMORY or CALLBACK).
  static TetrahedronMesh* create(Device& device, const TetrahedronInput& input);
  static void destroy(TetrahedronMesh* mesh) noexcept;

  TetrahedronMesh(Device& device, const TetrahedronInput& input);

  Device& device() const { return *device_; }
  kiwami_tetrahedra_info info() const;
  void locate(const LocationBatch& batch) const;

 private:
  void locate_block(const LocationBatch& batch) const;
  kiwami_tetrahedron_location locate_in_boxes(const Vec3f& point) const;

  Reference<Device> device_;
  uint32_t method_;
  TetrahedronSource source_;
  TetrahedronTree tree_;
  FaceTracer faces_;  ///< of the method FACES
  double build_seconds_ = 0.0;
};

}  // namespace kiwami
