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

inline vfloat<16> operator/(vfloat<16> a, vfloat<16> b) {
  return {simde_mm512_div_ps(a.value, b.value)};
}
inline simde__m512 with_bits_of(simde__m512 a, int32_t bits) {
  return simde_mm512_castsi512_ps(
      simde_mm512_and_epi32(simde_mm512_castps_si512(a), simde_mm512_set1_epi32(bits)));
}
inline vfloat<16> absolute(vfloat<16> a) { return {with_bits_of(a.value, 0x7FFFFFFF)}; }
inline vfloat<16> square_root(vfloat<16> a) { return {simde_mm512_sqrt_ps(a.value)}; }
inline vfloat<16> copy_sign(vfloat<16> magnitude, vfloat<16> sign) {
  return {simde_mm512_or_ps(magnitude.value, with_bits_of(sign.value, INT32_MIN))};
}
inline uint32_t sign_bits(vfloat<16> a) {
  return simde_mm512_movepi32_mask(simde_mm512_castps_si512(a.value));
}
inline vfloat<16> select_equal(vfloat<16> a, vfloat<16> b, vfloat<16> x, vfloat<16> y) {
  return {simde_mm512_mask_mov_ps(y.value, static_cast<simde__mmask16>(equal(a, b)), x.value)};
}
inline vfloat<16> select_negative(vfloat<16> sign, vfloat<16> x, vfloat<16> y) {
  return {simde_mm512_mask_mov_ps(y.value, static_cast<simde__mmask16>(sign_bits(sign)), x.value)};
}
inline vfloat<16> power_of_two_below(vfloat<16> a) { return {with_bits_of(a.value, 0x7F800000)}; }
inline vfloat<16> inverse_of_power(vfloat<16> a) {
  return {simde_mm512_castsi512_ps(
      simde_mm512_sub_epi32(simde_mm512_set1_epi32(254 << 23), simde_mm512_castps_si512(a.value)))};
}

/// Two of eight lanes as one of sixteen, and back.
inline vfloat<16> join(vfloat<8> low, vfloat<8> high) {
  return {simde_mm512_insertf32x8(simde_mm512_castps256_ps512(low.value), high.value, 1)};
}
inline vfloat<8> low_half(vfloat<16> a) { return {simde_mm512_castps512_ps256(a.value)}; }
inline vfloat<8> high_half(vfloat<16> a) {
  float lanes[16];
  store(lanes, a);
  return load<8>(lanes + 8);
}
inline vfloat<16> mark_less_equal(vfloat<16> marks, vfloat<16> a, vfloat<16> b, uint32_t bit) {
  const simde__m512 bits =
      simde_mm512_castsi512_ps(simde_mm512_set1_epi32(static_cast<int32_t>(bit)));
  const auto is_less = static_cast<simde__mmask16>(less_equal(a, b));
  return {simde_mm512_or_ps(marks.value,
                            simde_mm512_mask_mov_ps(simde_mm512_setzero_ps(), is_less, bits))};
}
inline uint32_t marked_lanes(vfloat<16> marks) {
  return marked_lanes(low_half(marks)) | marked_lanes(high_half(marks)) << 8;
}
inline void load_rows(const unsigned char* rows, size_t stride, vfloat<16> (&columns)[4]) {
  vfloat<8> low[4], high[4];
  load_rows(rows, stride, low);
  load_rows(rows + 8 * stride, stride, high);
  for (int k = 0; k < 4; ++k) columns[k] = join(low[k], high[k]);
}
inline void gather_rows(const unsigned char* const (&rows)[16], vfloat<16> (&columns)[3]) {
  const unsigned char *first[8], *last[8];
  for (int i = 0; i < 8; ++i) {
    first[i] = rows[i];
    last[i] = rows[i + 8];
  }
  vfloat<8> low[3], high[3];
  gather_rows(first, low);
  gather_rows(last, high);
  for (int k = 0; k < 3; ++k) columns[k] = join(low[k], high[k]);
}
inline void gather_between(const unsigned char* const (&rows)[16], size_t step, float start,
                           float end, vfloat<16> (&columns)[3]) {
  const unsigned char *first[8], *last[8];
  for (int i = 0; i < 8; ++i) {
    first[i] = rows[i];
    last[i] = rows[i + 8];
  }
  vfloat<8> low[3], high[3];
  gather_between(first, step, start, end, low);
  gather_between(last, step, start, end, high);
  for (int k = 0; k < 3; ++k) columns[k] = join(low[k], high[k]);
}
template <typename Target>
inline void store_rows(const vfloat<16> (&columns)[4], Target* const* targets, size_t offset) {
  const vfloat<8> low[4] = {low_half(columns[0]), low_half(columns[1]), low_half(columns[2]),
                            low_half(columns[3])};
  const vfloat<8> high[4] = {high_half(columns[0]), high_half(columns[1]), high_half(columns[2]),
                             high_half(columns[3])};
  store_rows(low, targets, offset);
  store_rows(high, targets + 8, offset);
}
inline float least_lane(vfloat<16> a) { return least_lane(min(low_half(a), high_half(a))); }
inline float greatest_lane(vfloat<16> a) { return greatest_lane(max(low_half(a), high_half(a))); }

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
