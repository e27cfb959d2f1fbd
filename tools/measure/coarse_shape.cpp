// SPDX-License-Identifier: Apache-2.0
#include "measure/coarse_shape.h"

#include <kiwami/kiwami.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <unordered_map>
#include <unordered_set>

#include "scene/vector.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kFinestGrid = 1024;  // cells along the longest side
constexpr uint32_t kNoVertex = ~0u;

using Corners = std::array<uint32_t, 3>;

struct HashCorners {
  size_t operator()(const Corners& corners) const {
    uint64_t hash = corners[0];
    hash = hash * 0x9E3779B97F4A7C15u + corners[1];
    hash = hash * 0x9E3779B97F4A7C15u + corners[2];
    return hash ^ (hash >> 29);
  }
};

bool is_usable(const float* vertex) {
  // Written so that NaN is refused.
  return std::abs(vertex[0]) <= KIWAMI_MAX_COORDINATE &&
         std::abs(vertex[1]) <= KIWAMI_MAX_COORDINATE &&
         std::abs(vertex[2]) <= KIWAMI_MAX_COORDINATE;
}

bool is_usable(const Mesh& mesh, const uint32_t* corners) {
  return is_usable(&mesh.vertices[size_t{corners[0]} * 3]) &&
         is_usable(&mesh.vertices[size_t{corners[1]} * 3]) &&
         is_usable(&mesh.vertices[size_t{corners[2]} * 3]);
}

/// Takes vertices and triangles, each once, and forgets those that have lost their area.
class Grid {
 public:
  /// With 0 cells every vertex stands for itself.
  Grid(const SceneFile& scene, uint32_t cells) : scene_(scene), cells_(cells) {
    for (const Mesh& mesh : scene.meshes) {
      for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
        if (!is_usable(&mesh.vertices[i])) continue;
        for (int axis = 0; axis < 3; ++axis) {
          lower_[axis] = std::min(lower_[axis], double{mesh.vertices[i + axis]});
          upper_[axis] = std::max(upper_[axis], double{mesh.vertices[i + axis]});
        }
      }
    }
    const double side =
        std::max({upper_[0] - lower_[0], upper_[1] - lower_[1], upper_[2] - lower_[2]});
    scale_ = side > 0.0 ? cells / side : 0.0;
  }

  /// The shape, or nothing when it has more triangles.
  bool fill(CoarseShape& shape, uint64_t most_triangles) {
    shape = CoarseShape();
    for (const Mesh& mesh : scene_.meshes) {
      std::vector<uint32_t> places(mesh.vertex_count(), kNoVertex);
      for (size_t i = 0; i < mesh.indices.size(); i += 3) {
        const uint32_t* corners = &mesh.indices[i];
        if (!is_usable(mesh, corners)) continue;
        Corners moved{};
        for (int k = 0; k < 3; ++k) moved[k] = place_of(mesh, corners[k], places, shape);
        if (!add(moved, shape)) continue;
        if (shape.triangle_count() > most_triangles) return false;
      }
    }
    return true;
  }

 private:
  uint32_t place_of(const Mesh& mesh, uint32_t vertex, std::vector<uint32_t>& places,
                    CoarseShape& shape) {
    uint32_t& place = places[vertex];
    if (place != kNoVertex) return place;
    const float* position = &mesh.vertices[size_t{vertex} * 3];
    const auto next = static_cast<uint32_t>(shape.vertices.size() / 3);
    place = cells_ == 0 ? next : vertex_of_cell_.try_emplace(cell_of(position), next).first->second;
    if (place == next) shape.vertices.insert(shape.vertices.end(), position, position + 3);
    return place;
  }

  uint64_t cell_of(const float* position) const {
    uint64_t cell = 0;
    for (int axis = 0; axis < 3; ++axis) {
      cell = cell << 16 | static_cast<uint64_t>((position[axis] - lower_[axis]) * scale_);
    }
    return cell;
  }

  bool add(const Corners& corners, CoarseShape& shape) {
    if (cells_ > 0) {
      Corners sorted = corners;
      std::sort(sorted.begin(), sorted.end());
      if (sorted[0] == sorted[1] || sorted[1] == sorted[2]) return false;
      if (!seen_.insert(sorted).second) return false;
    }
    shape.indices.insert(shape.indices.end(), corners.begin(), corners.end());
    return true;
  }

  const SceneFile& scene_;
  uint32_t cells_;
  double lower_[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL};
  double upper_[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL};
  double scale_ = 0.0;
  std::unordered_map<uint64_t, uint32_t> vertex_of_cell_;
  std::unordered_set<Corners, HashCorners> seen_;
};

/// Without the vertices that no triangle has.
CoarseShape without_spare_vertices(const CoarseShape& shape) {
  CoarseShape kept;
  std::vector<uint32_t> places(shape.vertices.size() / 3, kNoVertex);
  for (const uint32_t vertex : shape.indices) {
    if (places[vertex] == kNoVertex) {
      places[vertex] = static_cast<uint32_t>(kept.vertices.size() / 3);
      const auto position = shape.vertices.begin() + ptrdiff_t{vertex} * 3;
      kept.vertices.insert(kept.vertices.end(), position, position + 3);
    }
    kept.indices.push_back(places[vertex]);
  }
  return kept;
}

}  // namespace

CoarseShape coarse_shape(const SceneFile& scene, uint64_t most_triangles) {
  CoarseShape shape;
  if (Grid(scene, 0).fill(shape, most_triangles)) return shape;
  // A grid of one cell leaves nothing, which is few enough.
  uint32_t few_enough = 1;
  uint32_t too_many = kFinestGrid + 1;
  while (too_many - few_enough > std::max(few_enough / 16, 1u)) {
    const auto cells = static_cast<uint32_t>(std::sqrt(1.0 * few_enough * too_many));
    const uint32_t middle = std::clamp(cells, few_enough + 1, too_many - 1);
    CoarseShape finer;
    if (Grid(scene, middle).fill(finer, most_triangles)) {
      few_enough = middle;
      shape = std::move(finer);
    } else {
      too_many = middle;
    }
  }
  return few_enough == 1 ? CoarseShape() : without_spare_vertices(shape);
}

}  // namespace kiwami::tools
