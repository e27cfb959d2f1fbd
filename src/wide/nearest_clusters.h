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

/// The distance of two boxes is the area of the box around both. Its lowest bits are replaced by
/// the exclusive or of the two places: so the distances from one box differ, the other box can be
/// told from each, both of a pair see the same number, and of equal boxes neighbours are nearest.
class NearestClusters {
 public:
  static constexpr uint32_t kMostPlaces = 16;  ///< to each side, that can be looked at

  NearestClusters(Memory& memory, uint32_t capacity)
      : stride_(capacity + kMostPlaces + 4),
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

  /// Of two that are each other's nearest, both have the same distance, and nobody else has it
  /// within their reach.
  bool is_mutual(uint32_t place) const { return distances_[place] == distances_[nearest(place)]; }

  uint32_t nearest(uint32_t place) const {
    const uint32_t other = place ^ (distances_[place] & kPlaceBits);
    // The distance between the two places, known up to a multiple of 64, within +-16.
    const uint32_t apart = (other - place + 32) & kPlaceBits;
    return place + apart - 32;
  }

 private:
  static constexpr uint32_t kPlaceBits = 63;
  static_assert(2 * kMostPlaces < kPlaceBits);
  /// Farther than anything: coordinates are at most 2^60. Areas stay finite.
  static constexpr float kFar = 0x1p62f;

  float* row(int i) { return coordinates_.data() + i * stride_; }
  const float* row(int i) const { return coordinates_.data() + i * stride_; }

  size_t stride_;
  Array<float> coordinates_;  ///< three rows of lower, three of upper ones
  Array<uint32_t> distances_;
};

template <int Vectors>
void NearestClusters::find(uint32_t count) {
  static_assert(4 * Vectors <= kMostPlaces);
  for (uint32_t i = count; i < count + 4 * Vectors; ++i) {
    for (int k = 0; k < 6; ++k) row(k)[i] = kFar;
  }
  const simde__m128 infinity = simde_mm_set1_ps(std::numeric_limits<float>::infinity());
  const simde__m128i place_bits = simde_mm_set1_epi32(kPlaceBits);
  // The least distance of each of the next boxes to those before them.
  simde__m128 before[Vectors];
  simde__m128i places[Vectors];
  for (int v = 0; v < Vectors; ++v) {
    before[v] = infinity;
    places[v] = simde_mm_add_epi32(simde_mm_set_epi32(4, 3, 2, 1), simde_mm_set1_epi32(4 * v));
  }
  simde__m128 least_before = infinity;  // of this box
  simde__m128i own_place = simde_mm_setzero_si128();
  const simde__m128i one = simde_mm_set1_epi32(1);
  for (uint32_t i = 0; i < count; ++i) {
    const simde__m128 lower[3] = {simde_mm_set1_ps(row(0)[i]), simde_mm_set1_ps(row(1)[i]),
                                  simde_mm_set1_ps(row(2)[i])};
    const simde__m128 upper[3] = {simde_mm_set1_ps(row(3)[i]), simde_mm_set1_ps(row(4)[i]),
                                  simde_mm_set1_ps(row(5)[i])};
    simde__m128 least = infinity;
    for (int v = 0; v < Vectors; ++v) {
      simde__m128 extent[3];
      for (int axis = 0; axis < 3; ++axis) {
        const simde__m128 low = simde_mm_loadu_ps(row(axis) + i + 1 + 4 * v);
        const simde__m128 high = simde_mm_loadu_ps(row(3 + axis) + i + 1 + 4 * v);
        extent[axis] =
            simde_mm_sub_ps(simde_mm_max_ps(high, upper[axis]), simde_mm_min_ps(low, lower[axis]));
      }
      const simde__m128 area =
          simde_mm_add_ps(simde_mm_mul_ps(extent[0], simde_mm_add_ps(extent[1], extent[2])),
                          simde_mm_mul_ps(extent[1], extent[2]));
      const simde__m128i tag =
          simde_mm_and_si128(simde_mm_xor_si128(places[v], own_place), place_bits);
      const simde__m128 distance = simde_mm_castsi128_ps(
          simde_mm_or_si128(simde_mm_andnot_si128(place_bits, simde_mm_castps_si128(area)), tag));
      least = simde_mm_min_ps(least, distance);
      before[v] = simde_mm_min_ps(before[v], distance);
      places[v] = simde_mm_add_epi32(places[v], one);
    }
    least = simde_mm_min_ps(least, simde_mm_movehl_ps(least, least));
    least = simde_mm_min_ss(least, simde_mm_shuffle_ps(least, least, SIMDE_MM_SHUFFLE(1, 1, 1, 1)));
    least = simde_mm_min_ss(least, least_before);
    distances_[i] = std::bit_cast<uint32_t>(simde_mm_cvtss_f32(least));
    // Everything before moves up by one place.
    least_before = before[0];
    for (int v = 0; v < Vectors; ++v) {
      const simde__m128 next = v + 1 < Vectors ? before[v + 1] : infinity;
      const simde__m128 moved = simde_mm_move_ss(before[v], next);
      before[v] = simde_mm_shuffle_ps(moved, moved, SIMDE_MM_SHUFFLE(0, 3, 2, 1));
    }
    own_place = simde_mm_add_epi32(own_place, one);
  }
}

}  // namespace kiwami
