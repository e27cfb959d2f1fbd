// SPDX-License-Identifier: Apache-2.0
// Numbers whose differences between neighbouring pixels are large: so that errors are, too, and the
// eye (or a filter) takes them away.
#pragma once

#include <cstdint>

#include "kiwami/light.h"
#include "lights/roulette_numbers.h"

namespace kiwami {

constexpr uint32_t kBlueNoiseEdge = 64;
/// Each of 0 to 4095 once.
extern const uint16_t kBlueNoiseTile[kBlueNoiseEdge * kBlueNoiseEdge];

/// The numbers of one sample of a pixel: for each of many dimensions a low-discrepancy sequence over
/// the samples (multiples of an irrational number: the golden ratio in the first dimension, any in
/// each other, as equal ones would rise together), shifted around [0, 1) by a tile of blue noise over
/// the pixels, which lies elsewhere in each dimension. Over all seeds each number is uniform. The
/// random source of "Blue-Noise Dithered QMC Hierarchical Russian Roulette" (2019), by the additive
/// recurrence and the dithered shifts of I. Georgiev and M. Fajardo, "Blue-Noise Dithered Sampling",
/// SIGGRAPH Talks 2016.
class DitheredSource {
 public:
  DitheredSource(const kiwami_light_pixel& pixel, uint32_t seed) : pixel_(pixel), seed_(seed) {}

  /// In units of 2^-64.
  uint64_t fraction(uint64_t dimension) const {
    const uint64_t shift = mixed(dimension, seed_);
    const uint32_t x = (pixel_.x + static_cast<uint32_t>(shift)) % kBlueNoiseEdge;
    const uint32_t y = (pixel_.y + static_cast<uint32_t>(shift >> 16)) % kBlueNoiseEdge;
    const uint64_t rank = kBlueNoiseTile[y * kBlueNoiseEdge + x];
    // Beyond the tile's digits, any: those of this pixel in this dimension.
    const uint64_t pixel = uint64_t{pixel_.y} << 32 | pixel_.x;
    const uint64_t rest = mixed(dimension, mixed(pixel, seed_)) >> 12;
    constexpr uint64_t kGoldenRatio = 0x9E3779B97F4A7C15u;
    const uint64_t step = dimension == 2 * kFirstNumber ? kGoldenRatio : mixed(dimension, ~seed_);
    return (rank << 52 | rest) + pixel_.sample * step + mixed(~dimension, seed_);
  }

  /// As mixed_bits: a number in the first 53 bits, and a last bit that does not depend on them.
  uint64_t bits(uint64_t index) const {
    return (fraction(2 * index) & ~uint64_t{1}) | fraction(2 * index + 1) >> 63;
  }

 private:
  static uint64_t mixed(uint64_t index, uint64_t seed) { return mixed_integer(seed, index); }

  kiwami_light_pixel pixel_;
  uint64_t seed_;
};

}  // namespace kiwami
