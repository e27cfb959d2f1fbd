// SPDX-License-Identifier: Apache-2.0
// Opacity micromaps: what the point of a hit is like.
//
// After H. Gruen, C. Benthin, S. Woop, "Sub-triangle Opacity Masks for Faster Ray Tracing of
// Transparent Objects", Proceedings of the ACM on Computer Graphics and Interactive Techniques
// 3(2), 2020. It departs from the paper in the order of the micro-triangles, which is by rows.
#pragma once

#include "kiwami/opacity.h"
#include "math/micro_triangle.h"
#include "wide/wide_bvh.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// KIWAMI_OPACITY_* of a point of a triangle.
inline uint32_t opacity_at(const OpacityView& view, uint32_t primitive, float u, float v) {
  const uint32_t map = view.indices ? view.indices[primitive] : primitive;
  // The indices that stand for whole triangles end in what these are.
  if (map >= KIWAMI_OPACITY_ALL_TRANSPARENT) return map - KIWAMI_OPACITY_ALL_TRANSPARENT;
  const uint32_t bit = micro_triangle_at(u, v, view.level) * view.bits;
  const unsigned char byte = view.maps[map * view.map_bytes + bit / 8];
  return static_cast<uint32_t>(byte >> (bit % 8)) & ((1u << view.bits) - 1);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
