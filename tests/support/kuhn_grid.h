// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "support/random.h"

namespace kiwami_tests {

/// A mesh of tetrahedra with whole numbers as coordinates, so that an oracle can be exact.
struct TetrahedralGrid {
  struct Vertex {
    int32_t at[3];
  };
  struct Tetrahedron {
    uint32_t vertex[4];
  };

  std::vector<Vertex> vertices;
  std::vector<Tetrahedron> tetrahedra;
  int32_t extent;  ///< of the cube that it fills

  /// Times scale, which is a power of two, as the library takes them.
  std::vector<float> coordinates(float scale) const;
};

/// Cells in a cube, each divided into six tetrahedra around its diagonal (H. W. Kuhn, "Some
/// Combinatorial Lemmas in Topology", 1960), all of one orientation. Inner vertices are off their
/// place by at most jitter.
TetrahedralGrid kuhn_grid(uint32_t cells, int32_t cell_size, int32_t jitter, Random& random);

}  // namespace kiwami_tests
