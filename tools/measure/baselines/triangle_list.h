// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "measure/camera.h"
#include "scene/scene_file.h"

namespace kiwami::tools {

/// The corners of a triangle.
using Corners = std::array<Vec3, 3>;

/// All triangles of a scene without instances that the library does not skip: those whose vertices
/// are finite and within its largest coordinate.
std::vector<Corners> list_triangles(const SceneFile& file);

/// A box that holds nothing: anything that it is grown by becomes the box.
Box empty_box();
void grow(Box& box, Vec3 point);
void grow(Box& box, const Box& other);
Box box_of(const Corners& corners);

/// Half of the surface area; 0 for an empty box.
float half_area(const Box& box);

}  // namespace kiwami::tools
