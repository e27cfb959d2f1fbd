// SPDX-License-Identifier: Apache-2.0
// Geometries of all kinds by arguments of a fuzzer's choice. All return an empty handle where the
// call fails.
#pragma once

#include "fuzz/arguments.h"
#include "fuzz/handles.h"

namespace kiwami_fuzz {

/// No mesh has more vertices.
constexpr uint32_t kMostVertices = 3 * kMostElements;

Geometry make_mesh(Arguments& arguments, kiwami_device* device);
Geometry make_moving_mesh(Arguments& arguments, kiwami_device* device);
/// Spheres, discs or curves.
Geometry make_shapes(Arguments& arguments, kiwami_device* device);
/// Primitives whose callbacks answer anything.
Geometry make_user_geometry(Arguments& arguments, kiwami_device* device);
/// At rest or moving, of a scene that may be NULL.
Geometry make_instances(Arguments& arguments, kiwami_device* device, kiwami_scene* scene);

void set_opacity(Arguments& arguments, kiwami_geometry* mesh);

}  // namespace kiwami_fuzz
