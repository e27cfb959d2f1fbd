// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "measure/baselines/structure.h"

namespace kiwami::tools {
namespace {

constexpr float kCellsPerTriangle = 5.0f;
constexpr uint32_t kMaxCellsPerAxis = 1024;
constexpr uint64_t kMaxCells = uint64_t{1} << 26;
// A flat scene gets this share of its diagonal as thickness, on both sides.
constexpr float kPadding = 1e-4f;
// Cells are taken to be so much larger when triangles are put in, as rays pass by rounded planes.
constexpr float kOverlap = 1e-3f;

using CellIndex = std::array<uint32_t, 3>;

/// Cells of equal size, each with a list of the triangles in it. A ray walks from cell to cell
/// (J. Amanatides, A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics, 1987).
class UniformGrid final : public StructureOf<UniformGrid> {
 public:
  explicit UniformGrid(std::span<const Corners> triangles) {
    if (triangles.empty()) return;
    choose_cells(triangles);
    fill(triangles);
    std::vector<uint32_t> order(triangles.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    triangles_ = prepare_triangles(triangles, order);
  }

  uint64_t bytes() const override {
    return (starts_.size() + entries_.size()) * sizeof(uint32_t) +
           triangles_.size() * sizeof(PreparedTriangle);
  }

  template <bool kAnyHit, typename Probe>
  void trace(const kiwami_ray& given, BaselineHit& hit, Probe& probe) const {
    if (triangles_.empty()) return;
    const PreparedRay ray(given);
    float entry = ray.tmin;
    if (!enter(ray, hit.t, entry)) return;
    CellIndex cell = first_cell(ray, entry);
    Mailbox mailbox;
    for (;;) {
      probe.on_step();
      const auto [axis, exit] = leave(ray, cell);
      if (trace_cell<kAnyHit>(cell, ray, hit, mailbox, probe)) return;
      // A hit beyond this cell may lie behind another one.
      if (hit.t <= exit) return;
      const uint32_t next = ray.backwards[axis] ? cell[axis] - 1 : cell[axis] + 1;
      if (next >= counts_[axis]) return;
      cell[axis] = next;
    }
  }

 private:
  struct Exit {
    size_t axis;
    float distance;
  };

  void choose_cells(std::span<const Corners> triangles) {
    box_ = empty_box();
    for (const Corners& corners : triangles) grow(box_, box_of(corners));
    const float padding = std::max(box_.diagonal() * kPadding, std::numeric_limits<float>::min());
    box_.low = box_.low - Vec3{padding, padding, padding};
    box_.high = box_.high + Vec3{padding, padding, padding};
    const Vec3 extent = box_.extent();
    // In double: the volume of a large scene is beyond float.
    const double volume = double{extent.x} * double{extent.y} * double{extent.z};
    double density =
        std::cbrt(double{kCellsPerTriangle} * static_cast<double>(triangles.size()) / volume);
    do {
      for (int axis = 0; axis < 3; ++axis) {
        const double cells =
            std::clamp(double{extent[axis]} * density, 1.0, static_cast<double>(kMaxCellsPerAxis));
        counts_[static_cast<size_t>(axis)] = static_cast<uint32_t>(cells);
      }
      density *= 0.9;
    } while (cell_count() > kMaxCells);
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<size_t>(axis);
      size_[i] = extent[axis] / static_cast<float>(counts_[i]);
    }
  }

  uint64_t cell_count() const { return uint64_t{counts_[0]} * counts_[1] * counts_[2]; }

  size_t number_of(const CellIndex& cell) const {
    return (size_t{cell[2]} * counts_[1] + cell[1]) * counts_[0] + cell[0];
  }

  uint32_t cell_at(float position, int axis) const {
    const auto i = static_cast<size_t>(axis);
    const float cell = std::floor((position - box_.low[axis]) / size_[i]);
    return static_cast<uint32_t>(std::clamp(cell, 0.0f, static_cast<float>(counts_[i] - 1)));
  }

  float plane(uint32_t number, int axis) const {
    return box_.low[axis] + static_cast<float>(number) * size_[static_cast<size_t>(axis)];
  }

  /// Lists of the cells: counted first, then filled.
  void fill(std::span<const Corners> triangles) {
    starts_.assign(cell_count() + 1, 0);
    for (const Corners& corners : triangles) {
      for_each_cell(corners, [&](size_t cell) { ++starts_[cell + 1]; });
    }
    for (size_t i = 1; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    entries_.resize(starts_.back());
    std::vector<uint32_t> next(starts_.begin(), starts_.end() - 1);
    for (uint32_t i = 0; i < triangles.size(); ++i) {
      for_each_cell(triangles[i], [&](size_t cell) { entries_[next[cell]++] = i; });
    }
  }

  /// The cells in the triangle's box that its plane cuts.
  template <typename Body>
  void for_each_cell(const Corners& corners, const Body& body) const {
    const Box box = box_of(corners);
    CellIndex low;
    CellIndex high;
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<size_t>(axis);
      low[i] = cell_at(box.low[axis] - kOverlap * size_[i], axis);
      high[i] = cell_at(box.high[axis] + kOverlap * size_[i], axis);
    }
    const Vec3 normal = cross(corners[1] - corners[0], corners[2] - corners[0]);
    const Vec3 half = Vec3{size_[0], size_[1], size_[2]} * (0.5f + kOverlap);
    const float reach =
        std::abs(normal.x) * half.x + std::abs(normal.y) * half.y + std::abs(normal.z) * half.z;
    CellIndex cell;
    for (cell[2] = low[2]; cell[2] <= high[2]; ++cell[2]) {
      for (cell[1] = low[1]; cell[1] <= high[1]; ++cell[1]) {
        for (cell[0] = low[0]; cell[0] <= high[0]; ++cell[0]) {
          const Vec3 corner = {plane(cell[0], 0), plane(cell[1], 1), plane(cell[2], 2)};
          const Vec3 center = corner + Vec3{size_[0], size_[1], size_[2]} * 0.5f;
          // Written so that a plane that is beyond float keeps its cells.
          if (std::abs(dot(normal, center - corners[0])) > reach) continue;
          body(number_of(cell));
        }
      }
    }
  }

  bool enter(const PreparedRay& ray, float tmax, float& entry) const {
    float exit = tmax;
    for (int axis = 0; axis < 3; ++axis) {
      const float near = ray.backwards[axis] ? box_.high[axis] : box_.low[axis];
      const float far = ray.backwards[axis] ? box_.low[axis] : box_.high[axis];
      entry = std::max(entry, (near - ray.origin[axis]) * ray.inverse[axis]);
      exit = std::min(exit, (far - ray.origin[axis]) * ray.inverse[axis]);
    }
    return entry <= exit;
  }

  CellIndex first_cell(const PreparedRay& ray, float entry) const {
    const Vec3 point = ray.origin + ray.direction * entry;
    return {cell_at(point.x, 0), cell_at(point.y, 1), cell_at(point.z, 2)};
  }

  /// Through which side the ray leaves a cell, and where: from the cell's number, so that errors do
  /// not add up along the way.
  Exit leave(const PreparedRay& ray, const CellIndex& cell) const {
    Exit exit{0, std::numeric_limits<float>::infinity()};
    for (int axis = 0; axis < 3; ++axis) {
      const auto i = static_cast<size_t>(axis);
      const float side = plane(cell[i] + (ray.backwards[axis] ? 0 : 1), axis);
      const float distance = (side - ray.origin[axis]) * ray.inverse[axis];
      if (distance < exit.distance) exit = {i, distance};
    }
    return exit;
  }

  /// Whether the ray needs no more.
  template <bool kAnyHit, typename Probe>
  bool trace_cell(const CellIndex& cell, const PreparedRay& ray, BaselineHit& hit, Mailbox& mailbox,
                  Probe& probe) const {
    const size_t number = number_of(cell);
    for (uint32_t i = starts_[number]; i < starts_[number + 1]; ++i) {
      const uint32_t triangle = entries_[i];
      if (mailbox.has_seen(triangle)) continue;
      probe.on_triangle();
      const bool met = triangles_[triangle].intersect(ray.origin, ray.direction, ray.tmin, hit);
      if (kAnyHit && met) return true;
    }
    return false;
  }

  Box box_{};
  CellIndex counts_{};
  std::array<float, 3> size_{};
  std::vector<uint32_t> starts_;   ///< the first entry of each cell, and the end
  std::vector<uint32_t> entries_;  ///< triangles, cell by cell
  std::vector<PreparedTriangle> triangles_;
};

}  // namespace

std::unique_ptr<Structure> build_uniform_grid(std::span<const Corners> triangles) {
  return std::make_unique<UniformGrid>(triangles);
}

}  // namespace kiwami::tools
