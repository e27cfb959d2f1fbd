// SPDX-License-Identifier: Apache-2.0
// One ray against the N boxes of a wide node.
#pragma once

#include "kernels/ray-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The slots whose boxes the ray meets between its tmin and best, and the distances at which it
/// enters them. No operand is NaN: offsets are finite and boxes are bounded.
// Inlined by force: it stands in several loops of one kernel, so GCC would call it, which costs
// more than the test.
template <int N>
__attribute__((always_inline)) inline uint32_t test_boxes(const WideNode<N>& node,
                                                          const SlabRay<N>& ray, float best,
                                                          vfloat<N>& entry) {
  const auto planes = [&](size_t offset) __attribute__((always_inline)) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(node.bounds);
    return load<N>(reinterpret_cast<const float*>(bytes + offset));
  };
  const auto near_distance = [&](int axis) __attribute__((always_inline)) {
    return multiply_add(planes(ray.planes.near[axis]), ray.reciprocal[axis], ray.near_offset[axis]);
  };
  const auto far_distance = [&](int axis) __attribute__((always_inline)) {
    return multiply_add(planes(ray.planes.far[axis]), ray.reciprocal[axis], ray.far_offset[axis]);
  };
  entry = max(max(near_distance(0), near_distance(1)),
              max(near_distance(2), broadcast<N>(ray.nearest)));
  const vfloat<N> exit =
      min(min(far_distance(0), far_distance(1)), min(far_distance(2), broadcast<N>(best)));
  return less_equal(entry, exit);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
