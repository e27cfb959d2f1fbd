// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/scene.h"
#include "tetrahedra/tetrahedron_source.h"

namespace kiwami {

/// Points located by rays: the nearest face that a ray from the point meets is one of the
/// tetrahedron that contains it. Each face is there once, with the tetrahedra on its two sides, of
/// which the one is meant that the ray comes from.
///
/// After I. Wald, W. Usher, N. Morrical, L. Lediaev, V. Pascucci, "RTX Beyond Ray Tracing: Exploring
/// the Use of Hardware Ray Tracing Cores for Tet-Mesh Point Location", HPG short papers, 2019, with
/// shared faces. Departs from it in that rays are no longer than the longest edge, and in that the
/// answer is a candidate: rays are rounded, and say nothing of points that lie on a face.
class FaceTracer {
 public:
  struct Counts {
    uint64_t faces, boundary_faces, crowded_faces;
  };

  FaceTracer() = default;
  FaceTracer(const TetrahedronSource& source, Device& device);

  uint64_t bytes() const;
  const Counts& counts() const { return counts_; }

  /// The candidate of each point, or KIWAMI_INVALID_ID, on the calling thread. At most kMostPoints.
  static constexpr size_t kMostPoints = 256;
  void find_candidates(const Vec3f* points, size_t count, uint32_t* ids) const;

 private:
  /// The tetrahedra on the side to which the normal of a face points, and on the other.
  struct Sides {
    uint32_t above, below;
  };

  Array<Sides> sides_;  ///< by face
  Reference<Scene> scene_;
  float reach_ = 0.0f;  ///< of rays
  Counts counts_{};
};

}  // namespace kiwami
