// SPDX-License-Identifier: Apache-2.0
// Boxes in a row, and for each the nearest one within a few places: the inner loop of locally
// ordered clustering (see builders/ploc_builder.h), on 4-float vectors of the baseline instruction
// set.
#pragma once

#include <simde/x86/sse2.h>

#include <bit>
#include <cstdint>

#include "core/memory.h"
#include "math/vec3.h"

namespace kiwami {

/// The distance of two boxes is the area of the box around both (Bounds::half_area to the bit) and,
/// behind it in the lower half of a number of 64 bits, the exclusive or of the two places. So the
/// distances from one box differ, the other box can be told from each, both of a pair see the same
/// number, and of equal boxes neighbours are nearest. Each is computed once for both, and the places
/// stand behind it, as by C. Benthin, R. Drabinski, L. Tessari and A. Dittebrandt, "PLOC++: Parallel
/// Locally-Ordered Clustering for Bounding Volume Hierarchy Construction Revisited", PACMCGIT 5(3),
/// 2022. Such numbers have the same order as floats of 64 bits, which is how they are compared.
class NearestPlaces {
 public:
  static constexpr uint32_t kMostPlaces = 16;  ///< to each side, that can be looked at

  /// The first box is at first_place of all, which matters to distances that are equal.
  NearestPlaces(Memory& memory, uint32_t capacity, uint32_t first_place = 0)
      : first_place_(first_place),
        stride_(capacity + kMostPlaces + 4),
        coordinates_(memory, size_t{6} * stride_),
        distances_(memory, capacity) {}

  void set(uint32_t place, const Vec3f& lower, const Vec3f& upper) {
    for (int axis = 0; axis < 3; ++axis) {
      row(axis)[place] = lower[axis];
      row(3 + axis)[place] = upper[axis];
    }
  }

  void move(uint32_t from, uint32_t to) {
    for (int i = 0; i < 6; ++i) row(i)[to] = row(i)[from];
  }

  /// Finds the nearest of each of the first count boxes, at most 4 * Vectors places away.
  template <int Vectors>
  void find(uint32_t count);

  /// The same with a reach of 4, 8 or 16 places.
  void find(uint32_t count, uint32_t places) {
    if (places > 8) return find<4>(count);
    if (places > 4) return find<2>(count);
    find<1>(count);
  }

  /// Of two that are each other's nearest, both have the same distance, and nobody else has it
  /// within their reach.
  bool is_mutual(uint32_t place) const { return distances_[place] == distances_[nearest(place)]; }

  uint32_t nearest(uint32_t place) const {
    const auto differing = static_cast<uint32_t>(distances_[place]);
    return ((first_place_ + place) ^ differing) - first_place_;
  }

 private:
  /// Farther than anything: coordinates are at most 2^60. Areas stay finite.
  static constexpr float kFar = 0x1p62f;

  float* row(int i) { return coordinates_.data() + i * stride_; }
  const float* row(int i) const { return coordinates_.data() + i * stride_; }

  uint32_t first_place_;
  size_t stride_;
  Array<float> coordinates_;  ///< three rows of lower, three of upper ones
  Array<uint64_t> distances_;
};

template <int Vectors>
void NearestPlaces::find(uint32_t count) {
  static_assert(4 * Vectors <= kMostPlaces);
  for (uint32_t i = count; i < count + 4 * Vectors; ++i) {
    for (int k = 0; k < 6; ++k) row(k)[i] = kFar;
  }
  const simde__m128d infinity = simde_mm_set1_pd(std::numeric_limits<double>::infinity());
  // The least distance of each of the next boxes to those before them, two in a vector.
  simde__m128d before[2 * Vectors + 1];
  for (simde__m128d& distances : before) distances = infinity;
  simde__m128i own_place = simde_mm_set1_epi32(static_cast<int>(first_place_));
  const simde__m128i one = simde_mm_set1_epi32(1);
  for (uint32_t i = 0; i < count; ++i) {
    const simde__m128 lower[3] = {simde_mm_set1_ps(row(0)[i]), simde_mm_set1_ps(row(1)[i]),
                                  simde_mm_set1_ps(row(2)[i])};
    const simde__m128 upper[3] = {simde_mm_set1_ps(row(3)[i]), simde_mm_set1_ps(row(4)[i]),
                                  simde_mm_set1_ps(row(5)[i])};
    simde__m128d least = simde_mm_move_sd(infinity, before[0]);
    // Everything before moves up by one place.
    for (int v = 0; v < 2 * Vectors; ++v) {
      before[v] = simde_mm_shuffle_pd(before[v], before[v + 1], 1);
    }
    simde__m128i place = simde_mm_add_epi32(own_place, simde_mm_set_epi32(4, 3, 2, 1));
    for (int v = 0; v < Vectors; ++v) {
      simde__m128 extent[3];
      for (int axis = 0; axis < 3; ++axis) {
        const simde__m128 low = simde_mm_loadu_ps(row(axis) + i + 1 + 4 * v);
        const simde__m128 high = simde_mm_loadu_ps(row(3 + axis) + i + 1 + 4 * v);
        extent[axis] =
            simde_mm_sub_ps(simde_mm_max_ps(high, upper[axis]), simde_mm_min_ps(low, lower[axis]));
      }
      const simde__m128i area = simde_mm_castps_si128(
          simde_mm_add_ps(simde_mm_add_ps(simde_mm_mul_ps(extent[0], extent[1]),
                                          simde_mm_mul_ps(extent[1], extent[2])),
                          simde_mm_mul_ps(extent[2], extent[0])));
      const simde__m128i differing = simde_mm_xor_si128(place, own_place);
      const simde__m128d near = simde_mm_castsi128_pd(simde_mm_unpacklo_epi32(differing, area));
      const simde__m128d far = simde_mm_castsi128_pd(simde_mm_unpackhi_epi32(differing, area));
      least = simde_mm_min_pd(least, simde_mm_min_pd(near, far));
      before[2 * v] = simde_mm_min_pd(before[2 * v], near);
      before[2 * v + 1] = simde_mm_min_pd(before[2 * v + 1], far);
      place = simde_mm_add_epi32(place, simde_mm_set1_epi32(4));
    }
    least = simde_mm_min_sd(least, simde_mm_unpackhi_pd(least, least));
    distances_[i] = std::bit_cast<uint64_t>(simde_mm_cvtsd_f64(least));
    own_place = simde_mm_add_epi32(own_place, one);
  }
}

}  // namespace kiwami
