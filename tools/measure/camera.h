// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <cstdint>

#include "scene/scene_file.h"

namespace kiwami::tools {

constexpr float kDefaultFieldOfView = 45.0f;

/// An axis-aligned box.
struct Box {
  Vec3 low;
  Vec3 high;

  Vec3 center() const { return low * 0.5f + high * 0.5f; }
  Vec3 extent() const { return high - low; }
  float diagonal() const;
};

/// The box around what can be hit; the cube around the origin when nothing can.
Box bounds_of(const kiwami_scene_info& info);

/// A view that shows the whole box, from above and aside.
View fit_view(const Box& box, Vec3 up, float vertical_field_of_view, float aspect);

/// The view that the scene suggests, or one that shows all of it, the y axis upwards.
View default_view(const SceneFile& scene, const Box& box, float aspect);

/// A ray from `origin` with the defaults of all other fields.
kiwami_ray make_ray(Vec3 origin, Vec3 direction, float tmin, float tmax, float time = 0.0f);

/// A pinhole camera.
class Camera {
 public:
  /// `view.up` must not be parallel to the line of sight, nor eye and target be equal.
  Camera(const View& view, uint32_t width, uint32_t height);

  uint32_t width() const { return width_; }
  uint32_t height() const { return height_; }
  /// The ray through a point of the picture: (0, 0) is its upper left corner.
  kiwami_ray ray(float x, float y) const;

 private:
  Vec3 eye_;
  Vec3 corner_;
  Vec3 step_x_;
  Vec3 step_y_;
  uint32_t width_;
  uint32_t height_;
};

}  // namespace kiwami::tools
