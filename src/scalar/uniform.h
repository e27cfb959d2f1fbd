// SPDX-License-Identifier: Apache-2.0
// Uniform3 where a broadcast from memory costs as much as a load: the three stay where they are.
// Written over vfloat and broadcast, which the including vocabulary defines before.
#pragma once

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// 3 floats, each to be read as a vector of equal lanes.
template <int N>
struct Uniform3 {
  const float* lane;

  explicit Uniform3(const float* from) : lane(from) {}
  vfloat<N> operator[](int i) const { return broadcast<N>(lane[i]); }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
