// SPDX-License-Identifier: Apache-2.0
// Uniform4 where a broadcast from memory costs as much as a load: the four stay scalar. Written
// over vfloat, broadcast and store, which the including vocabulary defines before.
#pragma once

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// 4 floats, each to be read as a vector of equal lanes.
template <int N>
struct Uniform4 {
  float lane[4];

  vfloat<N> operator[](int i) const { return broadcast<N>(lane[i]); }
};
template <int N>
inline Uniform4<N> spread(vfloat<4> a) {
  Uniform4<N> result;
  store(result.lane, a);
  return result;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
