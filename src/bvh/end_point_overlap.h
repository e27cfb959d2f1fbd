// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bvh/triangle_source.h"
#include "core/memory.h"
#include "kiwami/bvh.h"
#include "parallel/parallel.h"

namespace kiwami {

/// How much foreign surface the boxes of a tree hold.
struct EndPointOverlap {
  Array<double> foreign_area;  ///< by node: the surface within its box of triangles that are not
                               ///< below it, relative to surface_area
  double surface_area = 0.0;   ///< of all triangles of the tree
};

/// What the end-point overlap of a tree is made of: T. Aila, T. Karras, S. Laine, "On Quality
/// Metrics of Bounding Volume Hierarchies", HPG 2013. Rays end on surfaces, and whoever ends within
/// a box has to visit it, whatever is in it. The loops are turned around: each triangle goes down
/// into the boxes that it overlaps and is cut by each on its way, so that what is left decides
/// where it goes next. primitive_ids has ids of the source in the order of the nodes' runs; an id
/// that stands there several times (spatial splits) is one triangle, at home wherever it stands.
/// Sums are taken in whole multiples of 2^-62 of the surface, so they do not depend on the threads.
EndPointOverlap measure_end_point_overlap(std::span<const kiwami_bvh_node> nodes,
                                          const Array<uint32_t>& primitive_ids,
                                          const TriangleSource& source, Memory& memory,
                                          const Parallel& parallel);

}  // namespace kiwami
