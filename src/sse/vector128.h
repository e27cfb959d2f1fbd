// SPDX-License-Identifier: Apache-2.0
// vfloat<4> on 128-bit registers, for every x86 instruction set and, through SIMDe, for NEON.
// The vocabulary is described in src/scalar/simd.h.
#pragma once

#include <simde/x86/fma.h>
#include <simde/x86/sse4.1.h>
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
inline vfloat<N> broadcast(float value);

template <>
inline vfloat<4> load<4>(const float* from) {
  return {simde_mm_loadu_ps(from)};
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
/// The magnitude is not negative.
inline vfloat<4> copy_sign(vfloat<4> magnitude, vfloat<4> sign) {
  return {simde_mm_or_ps(magnitude.value, simde_mm_and_ps(simde_mm_set1_ps(-0.0f), sign.value))};
}
/// In each of the first three lanes the greatest of them.
inline vfloat<4> greatest_of_three(vfloat<4> a) {
  const simde__m128 yzx = simde_mm_shuffle_ps(a.value, a.value, SIMDE_MM_SHUFFLE(0, 0, 2, 1));
  const simde__m128 zxy = simde_mm_shuffle_ps(a.value, a.value, SIMDE_MM_SHUFFLE(0, 1, 0, 2));
  return {simde_mm_max_ps(simde_mm_max_ps(a.value, yzx), zxy)};
}
/// In each lane the greatest power of two that is not above it; the lanes are positive and normal.
inline vfloat<4> power_of_two_below(vfloat<4> a) {
  return {simde_mm_and_ps(a.value, simde_mm_castsi128_ps(simde_mm_set1_epi32(0x7F800000)))};
}
/// In each lane the inverse of a power of two, 2^-126 to 2^126.
inline vfloat<4> inverse_of_power(vfloat<4> a) {
  return {simde_mm_castsi128_ps(
      simde_mm_sub_epi32(simde_mm_set1_epi32(254 << 23), simde_mm_castps_si128(a.value)))};
}
inline float first_lane(vfloat<4> a) { return simde_mm_cvtss_f32(a.value); }
inline uint32_t first_bits(vfloat<4> a) {
  return static_cast<uint32_t>(simde_mm_cvtsi128_si32(simde_mm_castps_si128(a.value)));
}
inline uint32_t sign_bits(vfloat<4> a) {
  return static_cast<uint32_t>(simde_mm_movemask_ps(a.value));
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
