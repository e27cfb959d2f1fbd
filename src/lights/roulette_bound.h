// SPDX-License-Identifier: Apache-2.0
// What a receiver of the roulette accepts of the lights in a box, at most.
#pragma once

#include <simde/x86/sse2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace kiwami {

/// By what, besides energy and squared distance, a light is accepted.
enum class RouletteLobe {
  kSphere,  ///< nothing, of what is not below the tangent plane
  kCosine,
  kTangentSphere,
  kEllipsoid
};

/// A receiver of the roulette, without its random number.
struct RouletteReceiver {
  float position[3];
  float normal[3];  ///< of length 1, or 0, 0, 0
  bool takes_both_sides;
  bool has_normal;
  RouletteLobe lobe;
  float axis[3];        ///< of the ellipsoid, of length 1
  double eccentricity;  ///< of the ellipsoid, 0 to below 1
  uint64_t link_mask;
};

/// A node of the roulette's tree.
struct RouletteNode {
  float centre[3], half_extent[3];
  float energy;  ///< of all leaves below; of a leaf its own
  float peak;    ///< the greatest of a leaf below
  uint64_t link_mask;
};

/// Which numbers a light below a node can be accepted by: without roots and divisions.
struct RouletteLimit {
  double scale, limit;

  bool admits(double number) const { return number * number * scale < limit; }
};

/// Single precision and slack serve, since leaves are decided exactly.
class RouletteBound {
 public:
  RouletteBound(const RouletteReceiver& receiver, double strength, double least_square)
      : position_(load(receiver.position)),
        normal_(load(receiver.normal)),
        axis_(load(receiver.axis)),
        lobe_(receiver.lobe),
        has_normal_(receiver.has_normal),
        takes_both_sides_(receiver.takes_both_sides),
        eccentricity_(receiver.eccentricity),
        strength_(kBoundSlack * strength),
        least_square_(least_square) {}

  /// Of a node's lights: p <= strength * peak * lobe / squared distance. Exact enough for numbers
  /// from least on; admits none of them where the distance alone is too far.
  RouletteLimit limit_of(const RouletteNode& node, double least) const {
    const simde__m128 half = load(node.half_extent);
    const simde__m128 offset = simde_mm_sub_ps(load(node.centre), position_);
    const double square = std::max(nearest_square(offset, half), least_square_);
    const double most = strength_ * static_cast<double>(node.peak);
    // No lobe is above 1: many nodes fail by their distance alone.
    if (!(least * square < most)) return {0.0, 0.0};
    double squared_cosine = square;  // times the square
    if (has_normal_) {
      const double top = top_along(normal_, takes_both_sides_, offset, half);
      if (!(top > 0.0)) return {0.0, 0.0};
      squared_cosine = std::min(square, top * top);
    }
    switch (lobe_) {
      case RouletteLobe::kSphere:
        break;
      case RouletteLobe::kCosine:
        return {square * square * square, most * most * squared_cosine};
      case RouletteLobe::kTangentSphere:
        return {square * square * square * square, most * squared_cosine * (most * squared_cosine)};
      case RouletteLobe::kEllipsoid: {
        const double top = top_along(axis_, false, offset, half);
        const double cosine = top > 0.0 ? std::min(1.0, top / std::sqrt(square)) : 0.0;
        const double radius = (1.0 - eccentricity_) / (1.0 - eccentricity_ * cosine);
        return {square * square, most * radius * radius * (most * radius * radius)};
      }
    }
    return {square * square, most * most};
  }

 private:
  /// More than rounding may take from a bound.
  static constexpr double kBoundSlack = 1.00001;
  static constexpr float kSumSlack = 1e-6f;
  /// Less than rounding may add to a difference.
  static constexpr float kDistanceSlack = 1.0f - 0x1p-22f;

  static simde__m128 coordinates() {
    return simde_mm_castsi128_ps(simde_mm_set_epi32(0, -1, -1, -1));
  }
  /// Three coordinates, of four floats that may be read, and 0.
  static simde__m128 load(const float* three) {
    return simde_mm_and_ps(simde_mm_loadu_ps(three), coordinates());
  }
  static simde__m128 absolute(simde__m128 a) {
    return simde_mm_andnot_ps(simde_mm_set1_ps(-0.0f), a);
  }
  static float sum_of(simde__m128 a) {
    const simde__m128 pairs = simde_mm_add_ps(a, simde_mm_movehl_ps(a, a));
    return simde_mm_cvtss_f32(
        simde_mm_add_ss(pairs, simde_mm_shuffle_ps(pairs, pairs, SIMDE_MM_SHUFFLE(1, 1, 1, 1))));
  }

  /// Of the distance to a box: not more than it is, but for rounding.
  static double nearest_square(simde__m128 offset, simde__m128 half) {
    const simde__m128 away = simde_mm_mul_ps(absolute(offset), simde_mm_set1_ps(kDistanceSlack));
    const simde__m128 gap = simde_mm_max_ps(simde_mm_sub_ps(away, half), simde_mm_setzero_ps());
    return static_cast<double>(sum_of(simde_mm_mul_ps(gap, gap)));
  }

  /// By how much a box rises along a direction, at most.
  static double top_along(simde__m128 direction, bool is_two_sided, simde__m128 offset,
                          simde__m128 half) {
    const simde__m128 along = absolute(direction);
    const simde__m128 rise = simde_mm_mul_ps(along, half);
    const simde__m128 size = simde_mm_add_ps(simde_mm_mul_ps(along, absolute(offset)), rise);
    const simde__m128 beyond =
        simde_mm_add_ps(rise, simde_mm_mul_ps(size, simde_mm_set1_ps(kSumSlack)));
    const float height = sum_of(simde_mm_mul_ps(direction, offset));
    const float most = sum_of(beyond) + (is_two_sided ? std::fabs(height) : height);
    return static_cast<double>(most + std::numeric_limits<float>::min());
  }

  simde__m128 position_, normal_, axis_;
  RouletteLobe lobe_;
  bool has_normal_, takes_both_sides_;
  double eccentricity_;
  double strength_;
  double least_square_;
};

}  // namespace kiwami
