// SPDX-License-Identifier: Apache-2.0
#include "measure/baselines/triangle_list.h"

#include <kiwami/kiwami.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiwami::tools {
namespace {

bool is_usable(Vec3 point) {
  // Written so that NaN is refused.
  return std::abs(point.x) <= KIWAMI_MAX_COORDINATE && std::abs(point.y) <= KIWAMI_MAX_COORDINATE &&
         std::abs(point.z) <= KIWAMI_MAX_COORDINATE;
}

}  // namespace

std::vector<Corners> list_triangles(const SceneFile& file) {
  std::vector<Corners> triangles;
  for (const Mesh& mesh : file.meshes) {
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
      Corners corners;
      for (size_t k = 0; k < 3; ++k) {
        const float* vertex = &mesh.vertices[size_t{mesh.indices[i + k]} * 3];
        corners[k] = {vertex[0], vertex[1], vertex[2]};
      }
      if (std::all_of(corners.begin(), corners.end(), is_usable)) triangles.push_back(corners);
    }
  }
  return triangles;
}

Box empty_box() {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
}

void grow(Box& box, Vec3 point) {
  box.low = {std::min(box.low.x, point.x), std::min(box.low.y, point.y),
             std::min(box.low.z, point.z)};
  box.high = {std::max(box.high.x, point.x), std::max(box.high.y, point.y),
              std::max(box.high.z, point.z)};
}

void grow(Box& box, const Box& other) {
  box.low = {std::min(box.low.x, other.low.x), std::min(box.low.y, other.low.y),
             std::min(box.low.z, other.low.z)};
  box.high = {std::max(box.high.x, other.high.x), std::max(box.high.y, other.high.y),
              std::max(box.high.z, other.high.z)};
}

Box box_of(const Corners& corners) {
  Box box = empty_box();
  for (const Vec3 corner : corners) grow(box, corner);
  return box;
}

float half_area(const Box& box) {
  const Vec3 size = box.high - box.low;
  if (!(size.x >= 0.0f)) return 0.0f;
  return size.x * size.y + size.y * size.z + size.z * size.x;
}

}  // namespace kiwami::tools
