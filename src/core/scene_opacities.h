// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "core/opacity_map.h"

namespace kiwami {

/// The opacity micromaps of the meshes of a committed scene, as they were when it was committed.
class SceneOpacities {
 public:
  SceneOpacities() = default;
  ~SceneOpacities() { clear(); }
  SceneOpacities(const SceneOpacities&) = delete;
  SceneOpacities& operator=(const SceneOpacities&) = delete;

  void clear() {
    for (size_t i = 0; i < held_; ++i) maps_[i]->release();
    held_ = 0;
    views_ = {};
    maps_ = {};
  }

  /// Takes the map of mesh number `mesh` of count, which may have none.
  void set(Memory& memory, size_t mesh, size_t count, OpacityMap* map) {
    if (!map) return;
    if (views_.empty()) {
      views_ = Array<OpacityView>(memory, count);
      views_.fill_zero();
      maps_ = Array<OpacityMap*>(memory, count);
    }
    views_[mesh] = map->view();
    map->retain();
    maps_[held_++] = map;
  }

  /// By the mesh's number; nullptr: no mesh has any.
  const OpacityView* views() const { return views_.empty() ? nullptr : views_.data(); }

 private:
  Array<OpacityView> views_;
  Array<OpacityMap*> maps_;
  size_t held_ = 0;
};

}  // namespace kiwami
