// SPDX-License-Identifier: Apache-2.0
// The inner loops of the binned surface area heuristic, on 4-float vectors of the baseline
// instruction set. Lane 3 of every box is whatever stood behind the coordinates.
#pragma once

#include <simde/x86/sse2.h>

#include <cstdint>

#include "bvh/binary_bvh.h"

namespace kiwami {

/// A box in two vectors.
struct VectorBounds {
  simde__m128 lower, upper;

  static VectorBounds empty() {
    const float infinity = std::numeric_limits<float>::infinity();
    return {simde_mm_set1_ps(infinity), simde_mm_set1_ps(-infinity)};
  }

  static VectorBounds of(const BuildPrimitive& primitive) {
    const float* words = reinterpret_cast<const float*>(&primitive);
    return {simde_mm_loadu_ps(words), simde_mm_loadu_ps(words + 4)};
  }

  /// The operand order keeps the accumulated value where the two are equal, so that the sign of a
  /// zero depends on the order of the primitives alone and not on how they are cut into blocks.
  void extend(const VectorBounds& other) {
    lower = simde_mm_min_ps(other.lower, lower);
    upper = simde_mm_max_ps(other.upper, upper);
  }

  /// Twice the centroid. Lane 3 is cleared: an id seen as a float is a denormal number, which
  /// makes multiplications slow.
  simde__m128 doubled_centroid() const {
    const simde__m128 coordinates = simde_mm_castsi128_ps(simde_mm_set_epi32(0, -1, -1, -1));
    return simde_mm_and_ps(simde_mm_add_ps(lower, upper), coordinates);
  }

  /// Bounds::half_area to the bit; the box is not empty.
  float half_area() const {
    const simde__m128 extent = simde_mm_sub_ps(upper, lower);
    const simde__m128 first = simde_mm_shuffle_ps(extent, extent, SIMDE_MM_SHUFFLE(2, 2, 1, 0));
    const simde__m128 second = simde_mm_shuffle_ps(extent, extent, SIMDE_MM_SHUFFLE(0, 0, 2, 1));
    const simde__m128 xy_yz_zx = simde_mm_mul_ps(first, second);
    const simde__m128 yz = simde_mm_shuffle_ps(xy_yz_zx, xy_yz_zx, SIMDE_MM_SHUFFLE(1, 1, 1, 1));
    const simde__m128 zx = simde_mm_shuffle_ps(xy_yz_zx, xy_yz_zx, SIMDE_MM_SHUFFLE(2, 2, 2, 2));
    return simde_mm_cvtss_f32(simde_mm_add_ss(simde_mm_add_ss(xy_yz_zx, yz), zx));
  }

  Bounds bounds() const {
    float low[4], high[4];
    simde_mm_storeu_ps(low, lower);
    simde_mm_storeu_ps(high, upper);
    return {{low[0], low[1], low[2]}, {high[0], high[1], high[2]}};
  }
};

/// The box of a range of primitives, and the box of their doubled centroids, which bins divide.
struct RangeBounds {
  VectorBounds geometry, centroids;

  static RangeBounds empty() { return {VectorBounds::empty(), VectorBounds::empty()}; }

  void extend(const BuildPrimitive& primitive) {
    const VectorBounds box = VectorBounds::of(primitive);
    const simde__m128 centroid = box.doubled_centroid();
    geometry.extend(box);
    centroids.extend({centroid, centroid});
  }

  void extend(const RangeBounds& other) {
    geometry.extend(other.geometry);
    centroids.extend(other.centroids);
  }
};

/// Maps centroids to bins: bin = (int)((centroid - origin) * scale) on each axis.
struct BinMapping {
  simde__m128 origin, scale;
  uint32_t bin_count;

  BinMapping() = default;
  BinMapping(const VectorBounds& centroids, uint32_t bins) : origin(centroids.lower) {
    bin_count = bins;
    const Bounds box = centroids.bounds();
    float factor[4] = {0.0f, 0.0f, 0.0f, 0.0f};
    for (int axis = 0; axis < 3; ++axis) {
      const float extent = box.upper[axis] - box.lower[axis];
      // The factor below 1 outweighs the three roundings, so the last bin is never passed. An
      // axis that is flat, or so short that its scale would overflow, has scale 0 and no split.
      if (extent > 1e-34f) factor[axis] = static_cast<float>(bins) * (1.0f - 1e-6f) / extent;
    }
    scale = simde_mm_loadu_ps(factor);
  }

  bool is_flat(int axis) const { return axis_of(scale, axis) == 0.0f; }

  void bins_of(simde__m128 centroid, int32_t bins[4]) const {
    const simde__m128 position = simde_mm_mul_ps(simde_mm_sub_ps(centroid, origin), scale);
    simde_mm_storeu_si128(reinterpret_cast<simde__m128i*>(bins), simde_mm_cvttps_epi32(position));
  }

  static float axis_of(simde__m128 vector, int axis) {
    float values[4];
    simde_mm_storeu_ps(values, vector);
    return values[axis];
  }
};

/// Decides on which side of a split a primitive goes: with the same arithmetic as bins_of.
struct SplitPlane {
  float origin, scale, first_right_bin;
  int axis;

  SplitPlane() = default;
  SplitPlane(const BinMapping& mapping, int split_axis, uint32_t last_left_bin)
      : origin(BinMapping::axis_of(mapping.origin, split_axis)),
        scale(BinMapping::axis_of(mapping.scale, split_axis)),
        first_right_bin(static_cast<float>(last_left_bin + 1)),
        axis(split_axis) {}

  bool is_right(const BuildPrimitive& primitive) const {
    return is_right_of(primitive.lower[axis] + primitive.upper[axis]);
  }

  /// Of a doubled coordinate.
  bool is_right_of(float doubled) const { return (doubled - origin) * scale >= first_right_bin; }
};

/// Boxes and counts of the bins of all three axes.
struct SahBins {
  static constexpr uint32_t kMaxBins = 32;

  VectorBounds box[kMaxBins][3];
  uint32_t count[kMaxBins][3];

  void clear(uint32_t bin_count) {
    for (uint32_t bin = 0; bin < bin_count; ++bin) {
      for (int axis = 0; axis < 3; ++axis) {
        box[bin][axis] = VectorBounds::empty();
        count[bin][axis] = 0;
      }
    }
  }

  /// Adds a primitive: all three axes at once, so that it is read from memory once.
  void add(const BuildPrimitive& primitive, const BinMapping& mapping) {
    const VectorBounds bounds = VectorBounds::of(primitive);
    int32_t bin[4];
    mapping.bins_of(bounds.doubled_centroid(), bin);
    for (int axis = 0; axis < 3; ++axis) {
      box[bin[axis]][axis].extend(bounds);
      ++count[bin[axis]][axis];
    }
  }

  void merge(const SahBins& other, uint32_t bin_count) {
    for (uint32_t bin = 0; bin < bin_count; ++bin) {
      for (int axis = 0; axis < 3; ++axis) {
        box[bin][axis].extend(other.box[bin][axis]);
        count[bin][axis] += other.count[bin][axis];
      }
    }
  }

  uint32_t count_left(int axis, uint32_t last_left_bin) const {
    uint32_t left = 0;
    for (uint32_t bin = 0; bin <= last_left_bin; ++bin) left += count[bin][axis];
    return left;
  }
};

}  // namespace kiwami
