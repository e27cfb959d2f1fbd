// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "core/opacity_map.h"

namespace kiwami {

/// The opacity micromaps of the meshes of a committed scene, as they were when it was committed.
class SceneOpacities {
 public:
  SceneOpacities() = default;
  ~SceneOpacities() {
    for (OpacityMap* map : maps_) {
      if (map) map->release();
    }
  }
  SceneOpacities(const SceneOpacities&) = delete;
  SceneOpacities& operator=(const SceneOpacities&) = delete;

  /// Takes the map of mesh number `mesh` of count, which may have none, in place of an earlier one.
  void set(Memory& memory, size_t mesh, size_t count, OpacityMap* map) {
    if (views_.empty()) {
      if (!map) return;
      views_ = Array<OpacityView>(memory, count);
      views_.fill_zero();
      maps_ = Array<OpacityMap*>(memory, count);
      maps_.fill_zero();
    }
    if (map) map->retain();
    if (maps_[mesh]) maps_[mesh]->release();
    maps_[mesh] = map;
    views_[mesh] = map ? map->view() : OpacityView{};
  }

  /// Of a mesh; nullptr: it has none.
  const OpacityMap* map_of(size_t mesh) const { return maps_.empty() ? nullptr : maps_[mesh]; }
  /// By the mesh's number; nullptr: no mesh has any.
  const OpacityView* views() const { return views_.empty() ? nullptr : views_.data(); }

 private:
  Array<OpacityView> views_;
  Array<OpacityMap*> maps_;  ///< by the mesh's number; references
};

}  // namespace kiwami
