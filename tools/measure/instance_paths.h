// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <vector>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Where the instances of a file that was saved lead: out of them, hits are carried into the world.
class InstancePaths {
 public:
  /// The file must outlive it. Throws LibraryError.
  InstancePaths(kiwami_device* device, const SceneFile& file);
  ~InstancePaths();
  InstancePaths(const InstancePaths&) = delete;
  InstancePaths& operator=(const InstancePaths&) = delete;

  bool empty() const { return scenes_.empty() || scenes_[0].empty(); }
  /// A hit at a time, with the numbers of its instances from the outermost on, which takes the
  /// place of its geometry.
  void move_to_world(const uint32_t* path, float time, kiwami_hit& hit) const;

 private:
  /// Instances of a scene are numbered through.
  struct Array {
    const SavedInstances* saved;
    uint32_t first;
    kiwami_geometry* geometry;
  };

  void add(kiwami_device* device, kiwami_scene* shown, const SavedInstances& saved,
           std::vector<Array>& arrays);
  void release();

  std::vector<std::vector<Array>> scenes_;
};

}  // namespace kiwami::tools
