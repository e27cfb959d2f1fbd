// SPDX-License-Identifier: Apache-2.0
// User geometries as kernels see them. Plain data.
#pragma once

#include <cstdint>

#include "kiwami/user_geometry.h"

namespace kiwami {

/// The primitives of one geometry.
struct UserView {
  kiwami_user_intersect_function intersect;
  void* user;
  uint32_t count;     ///< of primitives
  uint32_t first_id;  ///< the running id of primitive 0
  uint32_t geometry_id;
  uint32_t mask;
};

/// All user geometries of a scene, by rising first_id, without gaps.
struct UserSource {
  const UserView* views;
  uint32_t view_count;
};

}  // namespace kiwami
