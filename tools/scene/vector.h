// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>

namespace kiwami::tools {

/// Three numbers, in float for what the library sees and in double for what judges it.
template <typename T>
struct Vector3 {
  T x, y, z;
  T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
};

using Vec3 = Vector3<float>;
using Vec3d = Vector3<double>;

template <typename T>
Vector3<T> operator+(Vector3<T> a, Vector3<T> b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
Vector3<T> operator-(Vector3<T> a, Vector3<T> b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename T>
Vector3<T> operator*(Vector3<T> a, T s) {
  return {a.x * s, a.y * s, a.z * s};
}
template <typename T>
T dot(Vector3<T> a, Vector3<T> b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
Vector3<T> cross(Vector3<T> a, Vector3<T> b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
T length(Vector3<T> a) {
  return std::sqrt(dot(a, a));
}
/// The unit vector along `a`; NaN or infinite for a zero vector, which callers must rule out.
template <typename T>
Vector3<T> normalize(Vector3<T> a) {
  return a * (T(1) / length(a));
}

}  // namespace kiwami::tools
