// SPDX-License-Identifier: Apache-2.0
#include "measure/camera.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace kiwami::tools {
namespace {

/// Half the height of the picture at distance 1. In double, so that the last bit of the float does
/// not depend on the mathematical library.
float half_height(float vertical_field_of_view) {
  return static_cast<float>(
      std::tan(static_cast<double>(vertical_field_of_view) * std::numbers::pi / 360.0));
}

Vec3 any_perpendicular(Vec3 v) {
  const bool along_x = std::abs(v.x) > std::abs(v.y) && std::abs(v.x) > std::abs(v.z);
  return normalize(cross(v, along_x ? Vec3{0, 1, 0} : Vec3{1, 0, 0}));
}

}  // namespace

float Box::diagonal() const {
  const Vec3 size = extent();
  // The squares of coordinates near the limit would overflow in float.
  const double x = size.x;
  const double y = size.y;
  const double z = size.z;
  return static_cast<float>(std::sqrt(x * x + y * y + z * z));
}

Box bounds_of(const kiwami_scene_info& info) {
  if (info.triangle_count == 0) return {{-1, -1, -1}, {1, 1, 1}};
  return {{info.bounds_min[0], info.bounds_min[1], info.bounds_min[2]},
          {info.bounds_max[0], info.bounds_max[1], info.bounds_max[2]}};
}

View fit_view(const Box& box, Vec3 up, float vertical_field_of_view, float aspect) {
  const Vec3 top = normalize(up);
  const Vec3 side = any_perpendicular(top);
  const Vec3 front = cross(side, top);
  const Vec3 towards_eye = normalize(front * 0.8f + side * 0.5f + top * 0.45f);
  const float narrower = half_height(vertical_field_of_view) * std::min(1.0f, aspect);
  // A box of no size is seen from near by, but not from within its rounding.
  const Vec3 center = box.center();
  const float least =
      1e-4f * (1e-3f + std::abs(center.x) + std::abs(center.y) + std::abs(center.z));
  const float radius = std::max(0.5f * box.diagonal(), least);
  // A sphere of this radius touches the sides of the view: distance = radius / sin(angle).
  const float distance = radius * std::sqrt(1.0f + narrower * narrower) / narrower;
  return {center + towards_eye * distance, center, up, vertical_field_of_view};
}

View default_view(const SceneFile& scene, const Box& box, float aspect) {
  return scene.view ? *scene.view : fit_view(box, {0, 1, 0}, kDefaultFieldOfView, aspect);
}

kiwami_ray make_ray(Vec3 origin, Vec3 direction, float tmin, float tmax, float time) {
  return {origin.x,    origin.y, origin.z, tmin, direction.x, direction.y,
          direction.z, tmax,     time,     ~0u,  0,           0};
}

Camera::Camera(const View& view, uint32_t width, uint32_t height)
    : eye_(view.eye), width_(width), height_(height) {
  const Vec3 forward = normalize(view.target - view.eye);
  const Vec3 right = normalize(cross(forward, normalize(view.up)));
  const Vec3 down = cross(forward, right);
  const float step = 2.0f * half_height(view.vertical_field_of_view) / static_cast<float>(height);
  step_x_ = right * step;
  step_y_ = down * step;
  corner_ = forward - step_x_ * (0.5f * static_cast<float>(width)) -
            step_y_ * (0.5f * static_cast<float>(height));
}

kiwami_ray Camera::ray(float x, float y) const {
  return make_ray(eye_, normalize(corner_ + step_x_ * x + step_y_ * y), 0.0f,
                  std::numeric_limits<float>::infinity());
}

}  // namespace kiwami::tools
