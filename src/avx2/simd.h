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

inline vfloat<8> operator/(vfloat<8> a, vfloat<8> b) {
  return {simde_mm256_div_ps(a.value, b.value)};
}
inline vfloat<8> absolute(vfloat<8> a) {
  return {simde_mm256_andnot_ps(simde_mm256_set1_ps(-0.0f), a.value)};
}
inline vfloat<8> square_root(vfloat<8> a) { return {simde_mm256_sqrt_ps(a.value)}; }
inline vfloat<8> copy_sign(vfloat<8> magnitude, vfloat<8> sign) {
  return {simde_mm256_or_ps(magnitude.value,
                            simde_mm256_and_ps(simde_mm256_set1_ps(-0.0f), sign.value))};
}
inline uint32_t sign_bits(vfloat<8> a) {
  return static_cast<uint32_t>(simde_mm256_movemask_ps(a.value));
}
inline vfloat<8> select_equal(vfloat<8> a, vfloat<8> b, vfloat<8> x, vfloat<8> y) {
  return {simde_mm256_blendv_ps(y.value, x.value,
                                simde_mm256_cmp_ps(a.value, b.value, SIMDE_CMP_EQ_OQ))};
}
inline vfloat<8> select_negative(vfloat<8> sign, vfloat<8> x, vfloat<8> y) {
  return {simde_mm256_blendv_ps(y.value, x.value, sign.value)};
}
inline vfloat<8> power_of_two_below(vfloat<8> a) {
  return {
      simde_mm256_and_ps(a.value, simde_mm256_castsi256_ps(simde_mm256_set1_epi32(0x7F800000)))};
}
inline vfloat<8> inverse_of_power(vfloat<8> a) {
  return {simde_mm256_castsi256_ps(
      simde_mm256_sub_epi32(simde_mm256_set1_epi32(254 << 23), simde_mm256_castps_si256(a.value)))};
}

inline vfloat<8> mark_less_equal(vfloat<8> marks, vfloat<8> a, vfloat<8> b, uint32_t bit) {
  const simde__m256 bits =
      simde_mm256_castsi256_ps(simde_mm256_set1_epi32(static_cast<int32_t>(bit)));
  const simde__m256 is_less = simde_mm256_cmp_ps(a.value, b.value, SIMDE_CMP_LE_OQ);
  return {simde_mm256_or_ps(marks.value, simde_mm256_and_ps(is_less, bits))};
}
inline uint32_t marked_lanes(vfloat<8> marks) {
  const simde__m256i is_zero =
      simde_mm256_cmpeq_epi32(simde_mm256_castps_si256(marks.value), simde_mm256_setzero_si256());
  return ~static_cast<uint32_t>(simde_mm256_movemask_ps(simde_mm256_castsi256_ps(is_zero))) & 0xFFu;
}

/// Within each half, four rows of four to columns, or back.
inline void transpose(const simde__m256 (&rows)[4], simde__m256 (&columns)[4]) {
  const simde__m256 low01 = simde_mm256_unpacklo_ps(rows[0], rows[1]);
  const simde__m256 low23 = simde_mm256_unpacklo_ps(rows[2], rows[3]);
  const simde__m256 high01 = simde_mm256_unpackhi_ps(rows[0], rows[1]);
  const simde__m256 high23 = simde_mm256_unpackhi_ps(rows[2], rows[3]);
  columns[0] = simde_mm256_shuffle_ps(low01, low23, 0x44);
  columns[1] = simde_mm256_shuffle_ps(low01, low23, 0xEE);
  columns[2] = simde_mm256_shuffle_ps(high01, high23, 0x44);
  columns[3] = simde_mm256_shuffle_ps(high01, high23, 0xEE);
}
inline void load_rows(const unsigned char* rows, size_t stride, vfloat<8> (&columns)[4]) {
  const auto row_at = [&](size_t i) {
    return simde_mm_loadu_ps(reinterpret_cast<const float*>(rows + i * stride));
  };
  simde__m256 row[4], column[4];
  for (size_t i = 0; i < 4; ++i) {
    row[i] = simde_mm256_insertf128_ps(simde_mm256_castps128_ps256(row_at(i)), row_at(i + 4), 1);
  }
  transpose(row, column);
  for (int k = 0; k < 4; ++k) columns[k].value = column[k];
}
template <typename Target>
inline void store_rows(const vfloat<8> (&columns)[4], Target* const* targets, size_t offset) {
  const simde__m256 column[4] = {columns[0].value, columns[1].value, columns[2].value,
                                 columns[3].value};
  simde__m256 row[4];
  transpose(column, row);
  const auto put = [&](int i, simde__m128 four) {
    auto* const bytes = reinterpret_cast<unsigned char*>(targets[i]) + offset;
    simde_mm_storeu_ps(reinterpret_cast<float*>(bytes), four);
  };
  for (int i = 0; i < 4; ++i) {
    put(i, simde_mm256_castps256_ps128(row[i]));
    put(i + 4, simde_mm256_extractf128_ps(row[i], 1));
  }
}
inline simde__m128 load_three(const unsigned char* from) {
  return simde_mm_maskload_ps(reinterpret_cast<const float*>(from),
                              simde_mm_set_epi32(0, -1, -1, -1));
}
inline void gather_rows(const unsigned char* const (&rows)[4], vfloat<4> (&columns)[3]) {
  simde__m128 row[4], column[4];
  for (int i = 0; i < 4; ++i) row[i] = load_three(rows[i]);
  transpose(row, column);
  for (int k = 0; k < 3; ++k) columns[k].value = column[k];
}
inline void gather_rows(const unsigned char* const (&rows)[8], vfloat<8> (&columns)[3]) {
  simde__m256 row[4], column[4];
  for (int i = 0; i < 4; ++i) {
    row[i] = simde_mm256_insertf128_ps(simde_mm256_castps128_ps256(load_three(rows[i])),
                                       load_three(rows[i + 4]), 1);
  }
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
inline simde__m256 load_three_twice(const unsigned char* low, const unsigned char* high) {
  return simde_mm256_insertf128_ps(simde_mm256_castps128_ps256(load_three(low)), load_three(high),
                                   1);
}
// Inlined by force: the addresses of the rows need not go through memory.
__attribute__((always_inline)) inline void gather_between(const unsigned char* const (&rows)[8],
                                                          size_t step, float start, float end,
                                                          vfloat<8> (&columns)[3]) {
  const simde__m256 of_start = simde_mm256_set1_ps(start), of_end = simde_mm256_set1_ps(end);
  simde__m256 row[4], column[4];
#pragma GCC unroll 4
  for (int i = 0; i < 4; ++i) {
    row[i] = simde_mm256_add_ps(
        simde_mm256_mul_ps(of_start, load_three_twice(rows[i], rows[i + 4])),
        simde_mm256_mul_ps(of_end, load_three_twice(rows[i] + step, rows[i + 4] + step)));
  }
  transpose(row, column);
  for (int k = 0; k < 3; ++k) columns[k].value = column[k];
}
inline float least_lane(vfloat<8> a) {
  return least_lane(vfloat<4>{simde_mm_min_ps(simde_mm256_castps256_ps128(a.value),
                                              simde_mm256_extractf128_ps(a.value, 1))});
}
inline float greatest_lane(vfloat<8> a) {
  return greatest_lane(vfloat<4>{simde_mm_max_ps(simde_mm256_castps256_ps128(a.value),
                                                 simde_mm256_extractf128_ps(a.value, 1))});
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
inline uint32_t greater(vdouble4 a, vdouble4 b) {
  return static_cast<uint32_t>(
      simde_mm256_movemask_pd(simde_mm256_cmp_pd(a.value, b.value, SIMDE_CMP_GT_OQ)));
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

#include "scalar/uniform.h"
