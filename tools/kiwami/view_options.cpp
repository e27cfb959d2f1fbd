// SPDX-License-Identifier: Apache-2.0
#include "kiwami/view_options.h"

#include <cmath>

#include "kiwami/options.h"

namespace kiwami::tools {

void add_view_options(CLI::App& command, ViewOptions& options) {
  command.add_option("--eye", options.eye, "Where the camera stands: x,y,z");
  command.add_option("--target", options.target, "What it looks at: x,y,z");
  command.add_option("--up", options.up, "Which way is up: x,y,z");
  command.add_option("--fov", options.field_of_view, "Vertical field of view in degrees")
      ->check(finite_number(1, 170));
}

void check_view_options(const ViewOptions& options) {
  if (!options.eye.empty()) parse_vector("--eye", options.eye);
  if (!options.target.empty()) parse_vector("--target", options.target);
  if (!options.up.empty()) parse_vector("--up", options.up);
}

View choose_view(const ViewOptions& options, const SceneFile& file, const Box& box, float aspect) {
  const Vec3 up = options.up.empty() ? file.view ? file.view->up : Vec3{0, 1, 0}
                                     : parse_vector("--up", options.up);
  if (!(length(up) > 0.0f)) throw UsageError("--up is '" + options.up + "', which has no length");
  const float angle = options.field_of_view > 0.0 ? static_cast<float>(options.field_of_view)
                      : file.view                 ? file.view->vertical_field_of_view
                                                  : kDefaultFieldOfView;
  View view = file.view ? *file.view : fit_view(box, up, angle, aspect);
  view.up = up;
  view.vertical_field_of_view = angle;
  if (!options.eye.empty()) view.eye = parse_vector("--eye", options.eye);
  if (!options.target.empty()) view.target = parse_vector("--target", options.target);
  const Vec3 sight = view.target - view.eye;
  if (!(length(sight) > 0.0f) || !std::isfinite(length(sight))) {
    throw UsageError("the eye and the target are the same point, or too far apart");
  }
  if (!(length(cross(normalize(sight), normalize(up))) > 1e-6f)) {
    throw UsageError("the camera looks along its up vector");
  }
  return view;
}

}  // namespace kiwami::tools
