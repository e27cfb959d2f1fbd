// SPDX-License-Identifier: Apache-2.0
// Meshes and rays made from a seed with + - * / and square roots alone, so that every compiler and
// processor makes the same ones to the bit.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "kiwami/kiwami.h"

namespace generated {

/// xorshift64* (S. Vigna, An experimental exploration of Marsaglia's xorshift generators,
/// scrambled, ACM TOMS 2016).
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed ? seed : 1) {}

  uint32_t bits() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return static_cast<uint32_t>((state_ * 0x2545F4914F6CDD1Dull) >> 32);
  }
  uint32_t below(uint32_t limit) { return bits() % limit; }
  /// From -1 to 1 in odd multiples of 2^-23, so never 0.
  float symmetric() {
    return static_cast<float>(static_cast<int32_t>((bits() >> 9) * 2 + 1) - (1 << 23)) *
           (1.0f / (1 << 23));
  }

 private:
  uint64_t state_;
};

struct Vector {
  float x, y, z;
};

/// An indexed triangle mesh with a name for messages.
struct Mesh {
  const char* name;
  std::vector<Vector> vertices;
  std::vector<uint32_t> indices;

  size_t triangle_count() const { return indices.size() / 3; }
};

/// A closed mesh, the same far from the origin, slivers of all sizes, coplanar duplicates, meshes
/// with NaN and infinite vertices, a single triangle, none.
std::vector<Mesh> adversarial_meshes(uint64_t seed);

/// Rays at vertices and edges, along edges and axes, from inside, past the mesh, with limits and
/// culling, and some that are not valid.
std::vector<kiwami_ray> adversarial_rays(const Mesh& mesh, size_t count, Random& random);

}  // namespace generated
