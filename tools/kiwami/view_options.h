// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "measure/camera.h"
#include "scene/scene_file.h"

namespace kiwami::tools {

/// Where the camera stands, as the user said; "" and 0 leave it to the scene.
struct ViewOptions {
  std::string eye;
  std::string target;
  std::string up;
  double field_of_view = 0.0;

  bool empty() const { return eye.empty() && target.empty() && up.empty() && field_of_view == 0.0; }
};

/// Adds --eye, --target, --up and --fov.
void add_view_options(CLI::App& command, ViewOptions& options);

/// Throws UsageError for what is wrong whatever the scene.
void check_view_options(const ViewOptions& options);

/// The view of the options; what they leave out comes from the scene, or shows all of it. Throws
/// UsageError when the two make no camera.
View choose_view(const ViewOptions& options, const SceneFile& file, const Box& box, float aspect);

}  // namespace kiwami::tools
