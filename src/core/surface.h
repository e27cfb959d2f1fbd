// SPDX-License-Identifier: Apache-2.0
// What surfaces are like where rays hit them.
#pragma once

#include "core/committed_scene.h"
#include "core/triangle_mesh.h"
#include "kiwami/surface.h"

namespace kiwami {

/// A strided run of hits, at any address.
struct HitRun {
  const unsigned char* hits;
  size_t stride;
  size_t count;
};

/// Three floats for each hit, at any address; data may be null: not wanted.
struct VectorRun {
  unsigned char* data;
  size_t stride;
};

/// The points of hits and their errors. Throws Error(INVALID_ARGUMENT) for a hit that is on no mesh
/// of the scene.
void find_hit_points(const CommittedScene& scene, const HitRun& hits, const VectorRun& points,
                     const VectorRun& errors);

/// Origins of rays that leave hits in the directions given. Throws as find_hit_points.
void find_offset_origins(const CommittedScene& scene, const HitRun& hits,
                         const unsigned char* directions, size_t direction_stride,
                         const VectorRun& origins);

/// Interpolates an attribute at count elements; strides of 0 are replaced. Throws
/// Error(INVALID_ARGUMENT) for a number that names nothing.
void interpolate(const TriangleMesh& mesh, const kiwami_interpolation& interpolation, size_t count);

}  // namespace kiwami
