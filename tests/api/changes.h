// SPDX-License-Identifier: Apache-2.0
// What the tests of changing scenes share.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "api/api_support.h"
#include "support/random.h"

namespace kiwami_api_tests {

using kiwami_tests::Random;

inline kiwami_result update(const Geometry& mesh, const Triangles& triangles) {
  return kiwami_triangle_mesh_update_vertices(mesh.get(), triangles.vertices.data(), 0, 0);
}

inline void move_all(Triangles& triangles, float distance, Random& random) {
  for (float& coordinate : triangles.vertices) coordinate += distance * random.symmetric();
}

/// The answers of a new scene of these triangles.
inline std::vector<kiwami_hit> fresh_hits(const Device& device, const Triangles& triangles,
                                          const std::vector<kiwami_ray>& rays) {
  return closest_hits(make_scene(device, make_mesh(device, triangles.desc())), rays);
}

inline void expect_valid(const Scene& scene) {
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
}

}  // namespace kiwami_api_tests
