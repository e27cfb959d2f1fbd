// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "parity/committed_tree.h"
#include "support/library.h"

namespace kiwami_tests {

/// Scenes that are cut as much as they can be, for each width.
class SplitScene {
 public:
  explicit SplitScene(const Scene& scene) : device_(make_device(KIWAMI_ISA_SCALAR, 1)) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      BuildOptions options;
      options.width = width;
      options.validates = true;
      options.parameters = {{KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_SPATIAL_SPLIT},
                            {KIWAMI_PARAMETER_SPLIT_BUDGET, 4.0},
                            {KIWAMI_PARAMETER_SPLIT_ALPHA, 0.0}};
      scenes_[width / 8] = make_scene(device_.get(), scene, options);
    }
  }

  const kiwami::SceneView& view(uint32_t width) const { return view_of(scenes_[width / 8].get()); }

  kiwami_scene_info info(uint32_t width) const { return info_of(scenes_[width / 8].get()); }

  uint64_t extra_references() const {
    uint64_t extra = 0;
    for (const SceneHandle& scene : scenes_) {
      const kiwami_scene_info info = info_of(scene.get());
      extra += info.reference_count - info.triangle_count;
    }
    return extra;
  }

 private:
  DeviceHandle device_;
  SceneHandle scenes_[3];
};

}  // namespace kiwami_tests
