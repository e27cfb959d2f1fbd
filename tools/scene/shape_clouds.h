// SPDX-License-Identifier: Apache-2.0
// Generated scenes of spheres, discs and curve segments.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace kiwami::tools {

enum class CloudKind { kSpheres, kDiscs, kCurves };

struct ShapeCloud {
  CloudKind kind;
  std::vector<float> points;      ///< x, y, z, radius
  std::vector<float> normals;     ///< of discs: x, y, z
  std::vector<uint32_t> indices;  ///< of curves: the first of two points that follow each other

  size_t count() const { return kind == CloudKind::kCurves ? indices.size() : points.size() / 4; }
};

/// "spheres" and "discs" (a scanned surface: a wavy torus), "hair" (strands of 16 segments on a
/// ball), "grains" (spheres of many sizes that fill a box).
const std::vector<std::string>& cloud_names();

/// About count shapes. Throws std::invalid_argument for a name that is none of these.
ShapeCloud make_cloud(const std::string& name, uint32_t count);

}  // namespace kiwami::tools
