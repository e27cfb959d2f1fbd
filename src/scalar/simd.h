// SPDX-License-Identifier: Apache-2.0
// The vocabulary of the kernels in portable C++: the oracle of the other instruction sets.
//
//   vfloat<N>      N floats: load, load_from_bytes (at any address), store, + - * /, min, max,
//   multiply_add, square_root,
//                  comparisons to bit masks, signs, selections, powers of two; rows to columns and
//                  back, also from rows at any address
//   vfloat<4>      also greatest_of_three, first_bits, first_lane, third_in_all, with_last_of,
//                  rearrange: for axes in lanes
//   Uniform3<N>    3 floats, each to be read as a vector of equal lanes, many times
//   vdouble4       4 doubles, read from and written to floats; comparison to a bit mask
//
// min and max return their second operand where a lane is NaN or the two are equal, as the SSE
// instructions do. multiply_add may or may not be fused: only box tests, which have a margin for
// it, use it.
#pragma once

#include <stddef.h>
#include <stdint.h>

// By force: a call passes its vectors through memory, and GCC makes some where a kernel is large.
#define KIWAMI_INLINE __attribute__((always_inline)) inline

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

template <int N>
struct vfloat {
  float lane[N];
};

template <int N, typename Operation>
KIWAMI_INLINE vfloat<N> lane_by_lane(Operation operation) {
  vfloat<N> result;
  for (int i = 0; i < N; ++i) result.lane[i] = operation(i);
  return result;
}

template <int N, typename Predicate>
KIWAMI_INLINE uint32_t mask_of(Predicate predicate) {
  uint32_t mask = 0;
  for (int i = 0; i < N; ++i) mask |= static_cast<uint32_t>(predicate(i)) << i;
  return mask;
}

template <int N>
KIWAMI_INLINE vfloat<N> load(const float* from) {
  return lane_by_lane<N>([&](int i) { return from[i]; });
}
template <int N>
KIWAMI_INLINE vfloat<N> load_from_bytes(const void* from) {
  vfloat<N> result;
  __builtin_memcpy(&result, from, sizeof result);
  return result;
}
template <int N>
KIWAMI_INLINE vfloat<N> broadcast(float value) {
  return lane_by_lane<N>([&](int) { return value; });
}
template <int N>
KIWAMI_INLINE void store(float* to, vfloat<N> a) {
  for (int i = 0; i < N; ++i) to[i] = a.lane[i];
}

template <int N>
KIWAMI_INLINE vfloat<N> operator+(vfloat<N> a, vfloat<N> b) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] + b.lane[i]; });
}
template <int N>
KIWAMI_INLINE vfloat<N> operator-(vfloat<N> a, vfloat<N> b) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] - b.lane[i]; });
}
template <int N>
KIWAMI_INLINE vfloat<N> operator*(vfloat<N> a, vfloat<N> b) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] * b.lane[i]; });
}
template <int N>
KIWAMI_INLINE vfloat<N> multiply_add(vfloat<N> a, vfloat<N> b, vfloat<N> c) {
  return a * b + c;
}
template <int N>
KIWAMI_INLINE vfloat<N> min(vfloat<N> a, vfloat<N> b) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i]; });
}
template <int N>
KIWAMI_INLINE vfloat<N> max(vfloat<N> a, vfloat<N> b) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i]; });
}
template <int N>
KIWAMI_INLINE uint32_t less_equal(vfloat<N> a, vfloat<N> b) {
  return mask_of<N>([&](int i) { return a.lane[i] <= b.lane[i]; });
}
template <int N>
KIWAMI_INLINE uint32_t equal(vfloat<N> a, vfloat<N> b) {
  return mask_of<N>([&](int i) { return a.lane[i] == b.lane[i]; });
}

template <int N>
KIWAMI_INLINE vfloat<N> operator/(vfloat<N> a, vfloat<N> b) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] / b.lane[i]; });
}
template <int N>
KIWAMI_INLINE vfloat<N> absolute(vfloat<N> a) {
  return lane_by_lane<N>([&](int i) { return __builtin_fabsf(a.lane[i]); });
}
template <int N>
KIWAMI_INLINE vfloat<N> square_root(vfloat<N> a) {
  return lane_by_lane<N>([&](int i) { return __builtin_sqrtf(a.lane[i]); });
}
template <int N>
KIWAMI_INLINE vfloat<N> copy_sign(vfloat<N> magnitude, vfloat<N> sign) {
  return lane_by_lane<N>(
      [&](int i) { return __builtin_copysignf(magnitude.lane[i], sign.lane[i]); });
}
/// By its bits: vectorised, GCC 12's own function ends in an internal error.
KIWAMI_INLINE bool is_negative(float a) {
  int32_t bits;
  __builtin_memcpy(&bits, &a, sizeof bits);
  return bits < 0;
}
template <int N>
KIWAMI_INLINE uint32_t sign_bits(vfloat<N> a) {
  return mask_of<N>([&](int i) { return is_negative(a.lane[i]); });
}
/// Lanes of x where a equals b, else of y.
template <int N>
KIWAMI_INLINE vfloat<N> select_equal(vfloat<N> a, vfloat<N> b, vfloat<N> x, vfloat<N> y) {
  return lane_by_lane<N>([&](int i) { return a.lane[i] == b.lane[i] ? x.lane[i] : y.lane[i]; });
}
/// Lanes of x where the sign bit of sign is set, else of y.
template <int N>
KIWAMI_INLINE vfloat<N> select_negative(vfloat<N> sign, vfloat<N> x, vfloat<N> y) {
  return lane_by_lane<N>([&](int i) { return is_negative(sign.lane[i]) ? x.lane[i] : y.lane[i]; });
}

/// In each of the first three lanes the greatest of them; they are not negative.
KIWAMI_INLINE vfloat<4> greatest_of_three(vfloat<4> a) {
  const float xy = a.lane[0] < a.lane[1] ? a.lane[1] : a.lane[0];
  return broadcast<4>(xy < a.lane[2] ? a.lane[2] : xy);
}
KIWAMI_INLINE float with_bits(float value, uint32_t (*change)(uint32_t)) {
  uint32_t bits;
  __builtin_memcpy(&bits, &value, sizeof bits);
  bits = change(bits);
  __builtin_memcpy(&value, &bits, sizeof value);
  return value;
}
/// In each lane the greatest power of two that is not above it, or 0; the lanes are not negative.
template <int N>
KIWAMI_INLINE vfloat<N> power_of_two_below(vfloat<N> a) {
  return lane_by_lane<N>([&](int i) {
    return with_bits(a.lane[i], [](uint32_t bits) { return bits & 0x7F800000u; });
  });
}
/// In each lane the inverse of a power of two, 2^-126 to 2^126.
template <int N>
KIWAMI_INLINE vfloat<N> inverse_of_power(vfloat<N> a) {
  return lane_by_lane<N>([&](int i) {
    return with_bits(a.lane[i], [](uint32_t bits) { return (254u << 23) - bits; });
  });
}
KIWAMI_INLINE float first_lane(vfloat<4> a) { return a.lane[0]; }
/// The third lane in all four.
KIWAMI_INLINE vfloat<4> third_in_all(vfloat<4> a) { return broadcast<4>(a.lane[2]); }
/// The first three lanes of a and the last of b.
KIWAMI_INLINE vfloat<4> with_last_of(vfloat<4> a, vfloat<4> b) {
  return {{a.lane[0], a.lane[1], a.lane[2], b.lane[3]}};
}
/// An order of four lanes, by the bytes of each.
struct alignas(16) LaneOrder {
  uint8_t byte[16];
};
KIWAMI_INLINE vfloat<4> rearrange(vfloat<4> a, const LaneOrder& order) {
  return lane_by_lane<4>([&](int i) { return a.lane[order.byte[4 * i] / 4]; });
}
/// The bits of the first lane.
KIWAMI_INLINE uint32_t first_bits(vfloat<4> a) {
  uint32_t bits;
  __builtin_memcpy(&bits, a.lane, sizeof bits);
  return bits;
}

/// Bits that are set in each lane of marks, and those of bit where a <= b; and which lanes have
/// any.
template <int N>
KIWAMI_INLINE vfloat<N> mark_less_equal(vfloat<N> marks, vfloat<N> a, vfloat<N> b, uint32_t bit) {
  return lane_by_lane<N>([&](int i) {
    uint32_t bits;
    __builtin_memcpy(&bits, &marks.lane[i], sizeof bits);
    bits |= a.lane[i] <= b.lane[i] ? bit : 0;
    float marked;
    __builtin_memcpy(&marked, &bits, sizeof marked);
    return marked;
  });
}
template <int N>
KIWAMI_INLINE uint32_t marked_lanes(vfloat<N> marks) {
  return mask_of<N>([&](int i) {
    uint32_t bits;
    __builtin_memcpy(&bits, &marks.lane[i], sizeof bits);
    return bits != 0;
  });
}

/// Four columns from N rows of four floats, stride bytes apart.
template <int N>
KIWAMI_INLINE void load_rows(const unsigned char* rows, size_t stride, vfloat<N> (&columns)[4]) {
  for (int i = 0; i < N; ++i) {
    float row[4];
    __builtin_memcpy(row, rows + static_cast<size_t>(i) * stride, sizeof row);
    for (int k = 0; k < 4; ++k) columns[k].lane[i] = row[k];
  }
}
/// Three columns from N rows of three floats, each at an address of its own: no other byte is read.
template <int N>
KIWAMI_INLINE void gather_rows(const unsigned char* const (&rows)[N], vfloat<N> (&columns)[3]) {
  for (int i = 0; i < N; ++i) {
    float row[3];
    __builtin_memcpy(row, rows[i], sizeof row);
    for (int k = 0; k < 3; ++k) columns[k].lane[i] = row[k];
  }
}
/// The same of rows that lie between two of three floats: row i is start * (that at rows[i]) + end *
/// (that step bytes further), each product rounded.
template <int N>
KIWAMI_INLINE void gather_between(const unsigned char* const (&rows)[N], size_t step, float start,
                                  float end, vfloat<N> (&columns)[3]) {
  for (int i = 0; i < N; ++i) {
    float first[3], last[3];
    __builtin_memcpy(first, rows[i], sizeof first);
    __builtin_memcpy(last, rows[i] + step, sizeof last);
    for (int k = 0; k < 3; ++k) columns[k].lane[i] = start * first[k] + end * last[k];
  }
}
/// Writes row i of four columns to the floats that lie offset bytes into *targets[i].
template <int N, typename Target>
KIWAMI_INLINE void store_rows(const vfloat<N> (&columns)[4], Target* const* targets,
                              size_t offset) {
  for (int i = 0; i < N; ++i) {
    const float row[4] = {columns[0].lane[i], columns[1].lane[i], columns[2].lane[i],
                          columns[3].lane[i]};
    __builtin_memcpy(reinterpret_cast<unsigned char*>(targets[i]) + offset, row, sizeof row);
  }
}
template <int N>
KIWAMI_INLINE float least_lane(vfloat<N> a) {
  float least = a.lane[0];
  for (int i = 1; i < N; ++i) least = a.lane[i] < least ? a.lane[i] : least;
  return least;
}
template <int N>
KIWAMI_INLINE float greatest_lane(vfloat<N> a) {
  float most = a.lane[0];
  for (int i = 1; i < N; ++i) most = a.lane[i] > most ? a.lane[i] : most;
  return most;
}

struct vdouble4 {
  double lane[4];
};

template <typename Operation>
KIWAMI_INLINE vdouble4 double_by_double(Operation operation) {
  vdouble4 result;
  for (int i = 0; i < 4; ++i) result.lane[i] = operation(i);
  return result;
}
KIWAMI_INLINE vdouble4 load_widened(const float* from) {
  return double_by_double([&](int i) { return static_cast<double>(from[i]); });
}
KIWAMI_INLINE vdouble4 broadcast_double(double value) {
  return double_by_double([&](int) { return value; });
}
KIWAMI_INLINE void store(double* to, vdouble4 a) {
  for (int i = 0; i < 4; ++i) to[i] = a.lane[i];
}
KIWAMI_INLINE void store_rounded(float* to, vdouble4 a) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<float>(a.lane[i]);
}
KIWAMI_INLINE vdouble4 operator+(vdouble4 a, vdouble4 b) {
  return double_by_double([&](int i) { return a.lane[i] + b.lane[i]; });
}
KIWAMI_INLINE vdouble4 operator-(vdouble4 a, vdouble4 b) {
  return double_by_double([&](int i) { return a.lane[i] - b.lane[i]; });
}
KIWAMI_INLINE vdouble4 operator*(vdouble4 a, vdouble4 b) {
  return double_by_double([&](int i) { return a.lane[i] * b.lane[i]; });
}
KIWAMI_INLINE vdouble4 operator/(vdouble4 a, vdouble4 b) {
  return double_by_double([&](int i) { return a.lane[i] / b.lane[i]; });
}
KIWAMI_INLINE uint32_t greater(vdouble4 a, vdouble4 b) {
  return mask_of<4>([&](int i) { return a.lane[i] > b.lane[i]; });
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami

#undef KIWAMI_INLINE

#include "scalar/uniform.h"
