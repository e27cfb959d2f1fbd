// SPDX-License-Identifier: Apache-2.0
// Rays that stand for those which a scene will be asked for, and what they meet.
#pragma once

#include <span>

#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "kiwami/trace.h"

namespace kiwami {

struct RepresentativeRay {
  Vec3f origin;
  float tmin;
  Vec3f direction;
  float tmax;
};

/// Copies those of count rays, stride bytes apart (0: without gaps), that can hit anything.
Array<RepresentativeRay> copy_representative_rays(const kiwami_ray* rays, size_t stride,
                                                  size_t count, Memory& memory);

/// A guess at the rays of a picture, from points spread evenly over the surfaces: a third of them
/// distributed by the cosine on either side, a third as well but no longer than a quarter of the
/// scene's diagonal, and a third to points anywhere in the scene's box. The same for the same
/// triangles. None where no triangle has an area.
Array<RepresentativeRay> sample_rays(const TriangleSource& source, size_t count, Memory& memory);

/// A ray in double precision for statistics: what it meets is what an exact ray meets but for
/// roundings, which decide no answer.
class StatisticalRay {
 public:
  /// Boxes are relative to centre, triangles are not.
  StatisticalRay(const RepresentativeRay& ray, Vec3f centre) : tmin_(ray.tmin), tmax_(ray.tmax) {
    for (int axis = 0; axis < 3; ++axis) {
      origin_[axis] = ray.origin[axis];
      box_origin_[axis] = origin_[axis] - centre[axis];
      direction_[axis] = ray.direction[axis];
      // So far from 0 that no product with it is NaN.
      inverse_[axis] = 1.0 / (direction_[axis] == 0.0 ? 0x1p-900 : direction_[axis]);
    }
  }

  double tmax() const { return tmax_; }

  /// Where it enters a box between tmin and farthest; infinity where it does not.
  double enter(const Bounds& box, double farthest) const;

  /// Where it meets a triangle; infinity where it does not between tmin and tmax.
  double meet(const Vec3f corner[3]) const;

 private:
  double origin_[3], box_origin_[3], direction_[3], inverse_[3];
  double tmin_, tmax_;
};

}  // namespace kiwami
