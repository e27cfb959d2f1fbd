// SPDX-License-Identifier: Apache-2.0
// vfloat<4> on 128-bit registers, for every x86 instruction set and, through SIMDe, for NEON.
// The vocabulary is described in src/scalar/simd.h.
#pragma once

#include <simde/x86/fma.h>
#include <simde/x86/sse4.1.h>
#include <stddef.h>
#include <stdint.h>

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

template <int N>
struct vfloat;

template <>
struct vfloat<4> {
  simde__m128 value;
};

template <int N>
inline vfloat<N> load(const float* from);
template <int N>
inline vfloat<N> load_from_bytes(const void* from);
template <int N>
inline vfloat<N> broadcast(float value);

template <>
inline vfloat<4> load<4>(const float* from) {
  return {simde_mm_loadu_ps(from)};
}
template <>
inline vfloat<4> load_from_bytes<4>(const void* from) {
  return {simde_mm_loadu_ps(static_cast<const float*>(from))};
}
template <>
inline vfloat<4> broadcast<4>(float value) {
  return {simde_mm_set1_ps(value)};
}
inline void store(float* to, vfloat<4> a) { simde_mm_storeu_ps(to, a.value); }

inline vfloat<4> operator+(vfloat<4> a, vfloat<4> b) { return {simde_mm_add_ps(a.value, b.value)}; }
inline vfloat<4> operator-(vfloat<4> a, vfloat<4> b) { return {simde_mm_sub_ps(a.value, b.value)}; }
inline vfloat<4> operator*(vfloat<4> a, vfloat<4> b) { return {simde_mm_mul_ps(a.value, b.value)}; }
inline vfloat<4> multiply_add(vfloat<4> a, vfloat<4> b, vfloat<4> c) {
  return {simde_mm_fmadd_ps(a.value, b.value, c.value)};
}
inline vfloat<4> min(vfloat<4> a, vfloat<4> b) { return {simde_mm_min_ps(a.value, b.value)}; }
inline vfloat<4> max(vfloat<4> a, vfloat<4> b) { return {simde_mm_max_ps(a.value, b.value)}; }
inline uint32_t less_equal(vfloat<4> a, vfloat<4> b) {
  return static_cast<uint32_t>(simde_mm_movemask_ps(simde_mm_cmple_ps(a.value, b.value)));
}
inline uint32_t equal(vfloat<4> a, vfloat<4> b) {
  return static_cast<uint32_t>(simde_mm_movemask_ps(simde_mm_cmpeq_ps(a.value, b.value)));
}

inline vfloat<4> operator/(vfloat<4> a, vfloat<4> b) { return {simde_mm_div_ps(a.value, b.value)}; }
inline vfloat<4> absolute(vfloat<4> a) {
  return {simde_mm_andnot_ps(simde_mm_set1_ps(-0.0f), a.value)};
}
inline vfloat<4> square_root(vfloat<4> a) { return {simde_mm_sqrt_ps(a.value)}; }
/// The magnitude is not negative.
inline vfloat<4> copy_sign(vfloat<4> magnitude, vfloat<4> sign) {
  return {simde_mm_or_ps(magnitude.value, simde_mm_and_ps(simde_mm_set1_ps(-0.0f), sign.value))};
}
inline vfloat<4> select_equal(vfloat<4> a, vfloat<4> b, vfloat<4> x, vfloat<4> y) {
  return {simde_mm_blendv_ps(y.value, x.value, simde_mm_cmpeq_ps(a.value, b.value))};
}
inline vfloat<4> select_negative(vfloat<4> sign, vfloat<4> x, vfloat<4> y) {
  return {simde_mm_blendv_ps(y.value, x.value, sign.value)};
}
/// In each of the first three lanes the greatest of them.
inline vfloat<4> greatest_of_three(vfloat<4> a) {
  const simde__m128 yzx = simde_mm_shuffle_ps(a.value, a.value, SIMDE_MM_SHUFFLE(0, 0, 2, 1));
  const simde__m128 zxy = simde_mm_shuffle_ps(a.value, a.value, SIMDE_MM_SHUFFLE(0, 1, 0, 2));
  return {simde_mm_max_ps(simde_mm_max_ps(a.value, yzx), zxy)};
}
inline vfloat<4> power_of_two_below(vfloat<4> a) {
  return {simde_mm_and_ps(a.value, simde_mm_castsi128_ps(simde_mm_set1_epi32(0x7F800000)))};
}
inline vfloat<4> inverse_of_power(vfloat<4> a) {
  return {simde_mm_castsi128_ps(
      simde_mm_sub_epi32(simde_mm_set1_epi32(254 << 23), simde_mm_castps_si128(a.value)))};
}
inline float first_lane(vfloat<4> a) { return simde_mm_cvtss_f32(a.value); }
inline vfloat<4> third_in_all(vfloat<4> a) {
  return {simde_mm_shuffle_ps(a.value, a.value, SIMDE_MM_SHUFFLE(2, 2, 2, 2))};
}
inline vfloat<4> with_last_of(vfloat<4> a, vfloat<4> b) {
  return {simde_mm_blend_ps(a.value, b.value, 8)};
}
struct alignas(16) LaneOrder {
  uint8_t byte[16];
};
inline vfloat<4> rearrange(vfloat<4> a, const LaneOrder& order) {
  const simde__m128i bytes = simde_mm_load_si128(reinterpret_cast<const simde__m128i*>(order.byte));
  return {simde_mm_castsi128_ps(simde_mm_shuffle_epi8(simde_mm_castps_si128(a.value), bytes))};
}
inline uint32_t first_bits(vfloat<4> a) {
  return static_cast<uint32_t>(simde_mm_cvtsi128_si32(simde_mm_castps_si128(a.value)));
}
inline uint32_t sign_bits(vfloat<4> a) {
  return static_cast<uint32_t>(simde_mm_movemask_ps(a.value));
}

inline vfloat<4> mark_less_equal(vfloat<4> marks, vfloat<4> a, vfloat<4> b, uint32_t bit) {
  const simde__m128 bits = simde_mm_castsi128_ps(simde_mm_set1_epi32(static_cast<int32_t>(bit)));
  return {simde_mm_or_ps(marks.value, simde_mm_and_ps(simde_mm_cmple_ps(a.value, b.value), bits))};
}
inline uint32_t marked_lanes(vfloat<4> marks) {
  const simde__m128i is_zero =
      simde_mm_cmpeq_epi32(simde_mm_castps_si128(marks.value), simde_mm_setzero_si128());
  return ~static_cast<uint32_t>(simde_mm_movemask_ps(simde_mm_castsi128_ps(is_zero))) & 0xFu;
}

/// Four rows of four to columns, or back.
inline void transpose(const simde__m128 (&rows)[4], simde__m128 (&columns)[4]) {
  const simde__m128 low01 = simde_mm_unpacklo_ps(rows[0], rows[1]);
  const simde__m128 low23 = simde_mm_unpacklo_ps(rows[2], rows[3]);
  const simde__m128 high01 = simde_mm_unpackhi_ps(rows[0], rows[1]);
  const simde__m128 high23 = simde_mm_unpackhi_ps(rows[2], rows[3]);
  columns[0] = simde_mm_movelh_ps(low01, low23);
  columns[1] = simde_mm_movehl_ps(low23, low01);
  columns[2] = simde_mm_movelh_ps(high01, high23);
  columns[3] = simde_mm_movehl_ps(high23, high01);
}
inline void load_rows(const unsigned char* rows, size_t stride, vfloat<4> (&columns)[4]) {
  simde__m128 row[4], column[4];
  for (size_t i = 0; i < 4; ++i) {
    row[i] = simde_mm_loadu_ps(reinterpret_cast<const float*>(rows + i * stride));
  }
  transpose(row, column);
  for (int k = 0; k < 4; ++k) columns[k].value = column[k];
}
template <typename Target>
inline void store_rows(const vfloat<4> (&columns)[4], Target* const* targets, size_t offset) {
  const simde__m128 column[4] = {columns[0].value, columns[1].value, columns[2].value,
                                 columns[3].value};
  simde__m128 row[4];
  transpose(column, row);
  for (int i = 0; i < 4; ++i) {
    auto* const bytes = reinterpret_cast<unsigned char*>(targets[i]) + offset;
    simde_mm_storeu_ps(reinterpret_cast<float*>(bytes), row[i]);
  }
}
inline float least_lane(vfloat<4> a) {
  const simde__m128 two = simde_mm_min_ps(a.value, simde_mm_movehl_ps(a.value, a.value));
  return simde_mm_cvtss_f32(simde_mm_min_ps(two, simde_mm_shuffle_ps(two, two, 1)));
}
inline float greatest_lane(vfloat<4> a) {
  const simde__m128 two = simde_mm_max_ps(a.value, simde_mm_movehl_ps(a.value, a.value));
  return simde_mm_cvtss_f32(simde_mm_max_ps(two, simde_mm_shuffle_ps(two, two, 1)));
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
