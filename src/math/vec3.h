// SPDX-License-Identifier: Apache-2.0
// Three floats.
#pragma once

namespace kiwami {

struct Vec3f {
  float x, y, z;

  float& operator[](int axis) { return (&x)[axis]; }
  float operator[](int axis) const { return (&x)[axis]; }
};

inline Vec3f operator+(Vec3f a, Vec3f b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
inline Vec3f operator-(Vec3f a, Vec3f b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

}  // namespace kiwami
