// SPDX-License-Identifier: Apache-2.0
// The vocabulary of the kernels for AVX-512: see src/scalar/simd.h. Eight lanes and doubles are
// those of AVX2, compiled with the AVX-512 encodings (32 registers).
#pragma once

#include <simde/x86/avx512.h>

#include "avx2/simd.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

template <>
struct vfloat<16> {
  simde__m512 value;
};

template <>
inline vfloat<16> load<16>(const float* from) {
  return {simde_mm512_loadu_ps(from)};
}
template <>
inline vfloat<16> broadcast<16>(float value) {
  return {simde_mm512_set1_ps(value)};
}
inline void store(float* to, vfloat<16> a) { simde_mm512_storeu_ps(to, a.value); }

inline vfloat<16> operator+(vfloat<16> a, vfloat<16> b) {
  return {simde_mm512_add_ps(a.value, b.value)};
}
inline vfloat<16> operator-(vfloat<16> a, vfloat<16> b) {
  return {simde_mm512_sub_ps(a.value, b.value)};
}
inline vfloat<16> operator*(vfloat<16> a, vfloat<16> b) {
  return {simde_mm512_mul_ps(a.value, b.value)};
}
inline vfloat<16> multiply_add(vfloat<16> a, vfloat<16> b, vfloat<16> c) {
  return {simde_mm512_fmadd_ps(a.value, b.value, c.value)};
}
inline vfloat<16> min(vfloat<16> a, vfloat<16> b) { return {simde_mm512_min_ps(a.value, b.value)}; }
inline vfloat<16> max(vfloat<16> a, vfloat<16> b) { return {simde_mm512_max_ps(a.value, b.value)}; }
inline uint32_t less_equal(vfloat<16> a, vfloat<16> b) {
  return simde_mm512_cmp_ps_mask(a.value, b.value, SIMDE_CMP_LE_OQ);
}
inline uint32_t equal(vfloat<16> a, vfloat<16> b) {
  return simde_mm512_cmp_ps_mask(a.value, b.value, SIMDE_CMP_EQ_OQ);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
