// SPDX-License-Identifier: Apache-2.0
#include "support/kuhn_grid.h"

#include <utility>

namespace kiwami_tests {

std::vector<float> TetrahedralGrid::coordinates(float scale) const {
  std::vector<float> floats;
  for (const Vertex& vertex : vertices) {
    for (const int32_t at : vertex.at) floats.push_back(static_cast<float>(at) * scale);
  }
  return floats;
}

TetrahedralGrid kuhn_grid(uint32_t cells, int32_t cell_size, int32_t jitter, Random& random) {
  TetrahedralGrid grid;
  grid.extent = static_cast<int32_t>(cells) * cell_size;
  const uint32_t edge = cells + 1;
  for (uint32_t i = 0; i < edge * edge * edge; ++i) {
    const uint32_t place[3] = {i % edge, i / edge % edge, i / edge / edge};
    TetrahedralGrid::Vertex vertex{};
    for (int axis = 0; axis < 3; ++axis) {
      const bool is_inner = place[axis] != 0 && place[axis] != cells;
      vertex.at[axis] = static_cast<int32_t>(place[axis]) * cell_size +
                        (is_inner && jitter > 0 ? random.between(-jitter, jitter) : 0);
    }
    grid.vertices.push_back(vertex);
  }
  const uint32_t step[3] = {1, edge, edge * edge};
  constexpr int kPaths[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}};
  for (uint32_t cell = 0; cell < cells * cells * cells; ++cell) {
    const uint32_t corner =
        cell % cells + cell / cells % cells * step[1] + cell / cells / cells * step[2];
    for (int path = 0; path < 6; ++path) {
      TetrahedralGrid::Tetrahedron one{{corner, 0, 0, 0}};
      for (int i = 0; i < 3; ++i) one.vertex[i + 1] = one.vertex[i] + step[kPaths[path][i]];
      // Odd orders of the axes are mirror images of the even ones.
      if (path >= 3) std::swap(one.vertex[1], one.vertex[2]);
      grid.tetrahedra.push_back(one);
    }
  }
  return grid;
}

}  // namespace kiwami_tests
