// SPDX-License-Identifier: Apache-2.0
// The vocabulary of the kernels for AVX2 and FMA: see src/scalar/simd.h.
#pragma once

#include <simde/x86/avx2.h>

#include "sse/vector128.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

template <>
struct vfloat<8> {
  simde__m256 value;
};

template <>
inline vfloat<8> load<8>(const float* from) {
  return {simde_mm256_loadu_ps(from)};
}
template <>
inline vfloat<8> broadcast<8>(float value) {
  return {simde_mm256_set1_ps(value)};
}
inline void store(float* to, vfloat<8> a) { simde_mm256_storeu_ps(to, a.value); }

inline vfloat<8> operator+(vfloat<8> a, vfloat<8> b) {
  return {simde_mm256_add_ps(a.value, b.value)};
}
inline vfloat<8> operator-(vfloat<8> a, vfloat<8> b) {
  return {simde_mm256_sub_ps(a.value, b.value)};
}
inline vfloat<8> operator*(vfloat<8> a, vfloat<8> b) {
  return {simde_mm256_mul_ps(a.value, b.value)};
}
inline vfloat<8> multiply_add(vfloat<8> a, vfloat<8> b, vfloat<8> c) {
  return {simde_mm256_fmadd_ps(a.value, b.value, c.value)};
}
inline vfloat<8> min(vfloat<8> a, vfloat<8> b) { return {simde_mm256_min_ps(a.value, b.value)}; }
inline vfloat<8> max(vfloat<8> a, vfloat<8> b) { return {simde_mm256_max_ps(a.value, b.value)}; }
inline uint32_t less_equal(vfloat<8> a, vfloat<8> b) {
  return static_cast<uint32_t>(
      simde_mm256_movemask_ps(simde_mm256_cmp_ps(a.value, b.value, SIMDE_CMP_LE_OQ)));
}
inline uint32_t equal(vfloat<8> a, vfloat<8> b) {
  return static_cast<uint32_t>(
      simde_mm256_movemask_ps(simde_mm256_cmp_ps(a.value, b.value, SIMDE_CMP_EQ_OQ)));
}

struct vdouble4 {
  simde__m256d value;
};

inline vdouble4 load_widened(const float* from) {
  return {simde_mm256_cvtps_pd(simde_mm_loadu_ps(from))};
}
inline vdouble4 broadcast_double(double value) { return {simde_mm256_set1_pd(value)}; }
inline void store(double* to, vdouble4 a) { simde_mm256_storeu_pd(to, a.value); }
inline void store_rounded(float* to, vdouble4 a) {
  simde_mm_storeu_ps(to, simde_mm256_cvtpd_ps(a.value));
}
inline vdouble4 operator+(vdouble4 a, vdouble4 b) { return {simde_mm256_add_pd(a.value, b.value)}; }
inline vdouble4 operator-(vdouble4 a, vdouble4 b) { return {simde_mm256_sub_pd(a.value, b.value)}; }
inline vdouble4 operator*(vdouble4 a, vdouble4 b) { return {simde_mm256_mul_pd(a.value, b.value)}; }
inline vdouble4 operator/(vdouble4 a, vdouble4 b) { return {simde_mm256_div_pd(a.value, b.value)}; }

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

#include "scalar/uniform.h"
