// SPDX-License-Identifier: Apache-2.0
// The vocabulary of the kernels for SSE4.1: see src/scalar/simd.h.
#pragma once

#include "sse/vector128.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// A broadcast takes a shuffle beside the load, so it is done once.
template <int N>
struct Uniform3 {
  vfloat<N> lane[3];

  explicit Uniform3(const float* from)
      : lane{broadcast<N>(from[0]), broadcast<N>(from[1]), broadcast<N>(from[2])} {
    // Forget that the lanes are equal: knowing it, GCC reckons lane by lane.
    asm("" : "+m"(lane));
  }
  vfloat<N> operator[](int i) const { return lane[i]; }
};

inline simde__m128 load_three(const unsigned char* from) {
  int32_t last;
  __builtin_memcpy(&last, from + 2 * sizeof(float), sizeof last);
  const simde__m128i two = simde_mm_loadl_epi64(reinterpret_cast<const simde__m128i*>(from));
  return simde_mm_castsi128_ps(simde_mm_insert_epi32(two, last, 2));
}
inline void gather_rows(const unsigned char* const (&rows)[4], vfloat<4> (&columns)[3]) {
  simde__m128 row[4], column[4];
  for (int i = 0; i < 4; ++i) row[i] = load_three(rows[i]);
  transpose(row, column);
  for (int k = 0; k < 3; ++k) columns[k].value = column[k];
}
inline void gather_between(const unsigned char* const (&rows)[4], size_t step, float start,
                           float end, vfloat<4> (&columns)[3]) {
  const simde__m128 of_start = simde_mm_set1_ps(start), of_end = simde_mm_set1_ps(end);
  simde__m128 row[4], column[4];
  for (int i = 0; i < 4; ++i) {
    row[i] = simde_mm_add_ps(simde_mm_mul_ps(of_start, load_three(rows[i])),
                             simde_mm_mul_ps(of_end, load_three(rows[i] + step)));
  }
  transpose(row, column);
  for (int k = 0; k < 3; ++k) columns[k].value = column[k];
}

struct vdouble4 {
  simde__m128d low, high;
};

inline vdouble4 load_widened(const float* from) {
  const simde__m128 floats = simde_mm_loadu_ps(from);
  return {simde_mm_cvtps_pd(floats), simde_mm_cvtps_pd(simde_mm_movehl_ps(floats, floats))};
}
inline vdouble4 broadcast_double(double value) {
  const simde__m128d both = simde_mm_set1_pd(value);
  return {both, both};
}
inline void store(double* to, vdouble4 a) {
  simde_mm_storeu_pd(to, a.low);
  simde_mm_storeu_pd(to + 2, a.high);
}
inline void store_rounded(float* to, vdouble4 a) {
  const simde__m128 low = simde_mm_cvtpd_ps(a.low), high = simde_mm_cvtpd_ps(a.high);
  simde_mm_storeu_ps(to, simde_mm_movelh_ps(low, high));
}
inline vdouble4 operator+(vdouble4 a, vdouble4 b) {
  return {simde_mm_add_pd(a.low, b.low), simde_mm_add_pd(a.high, b.high)};
}
inline vdouble4 operator-(vdouble4 a, vdouble4 b) {
  return {simde_mm_sub_pd(a.low, b.low), simde_mm_sub_pd(a.high, b.high)};
}
inline vdouble4 operator*(vdouble4 a, vdouble4 b) {
  return {simde_mm_mul_pd(a.low, b.low), simde_mm_mul_pd(a.high, b.high)};
}
inline vdouble4 operator/(vdouble4 a, vdouble4 b) {
  return {simde_mm_div_pd(a.low, b.low), simde_mm_div_pd(a.high, b.high)};
}
inline uint32_t greater(vdouble4 a, vdouble4 b) {
  const int low = simde_mm_movemask_pd(simde_mm_cmpgt_pd(a.low, b.low));
  const int high = simde_mm_movemask_pd(simde_mm_cmpgt_pd(a.high, b.high));
  return static_cast<uint32_t>(low | high << 2);
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
