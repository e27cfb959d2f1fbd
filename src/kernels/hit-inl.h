// SPDX-License-Identifier: Apache-2.0
// What a hit says of itself beside its distance and its place.
#pragma once

#include "kernels/query-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Where the hit of an accepted lane is on its triangle, and the triangle's normal.
template <int N>
inline void describe_triangle(const LeafBlock<N>& leaf, int lane, const Crossings<N>& crossings,
                              kiwami_hit& hit) {
  hit.u = static_cast<float>(crossings.v[lane] / crossings.sum[lane]);
  hit.v = static_cast<float>(crossings.w[lane] / crossings.sum[lane]);
  const auto corner = [&](int k, int axis) { return leaf.position[k][axis][lane]; };
  const auto edge = [&](int k, int axis) { return corner(k, axis) - corner(0, axis); };
  hit.normal_x = edge(1, 1) * edge(2, 2) - edge(1, 2) * edge(2, 1);
  hit.normal_y = edge(1, 2) * edge(2, 0) - edge(1, 0) * edge(2, 2);
  hit.normal_z = edge(1, 0) * edge(2, 1) - edge(1, 1) * edge(2, 0);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
