// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "math/bounds.h"

namespace kiwami {

/// Whether boxes together cover a triangle, both relative to origin, in double precision: gaps of
/// less than 2^-36 of the triangle's coordinates, far below the rounding of a float, go unseen.
/// Reorders the boxes.
bool is_covered(const Vec3f corner[3], const Vec3f& origin, std::span<Bounds> boxes);

}  // namespace kiwami
