// SPDX-License-Identifier: Apache-2.0
#include "io/scene_walk.h"

#include <algorithm>
#include <functional>

#include "core/error.h"
#include "core/instances.h"
#include "io/file_format.h"

namespace kiwami::file {
namespace {

void check_kind(const Geometry& geometry, size_t geometry_id) {
  if (geometry.kind() != GeometryKind::kUser) return;
  throw Error(KIWAMI_ERROR_INVALID_STATE,
              "geometry %zu is a user geometry, expected none in a scene that is saved, nor in one "
              "that it shows: files cannot hold its functions",
              geometry_id);
}

/// A scene on the way from the root.
struct Place {
  SceneToSave scene;
  uint32_t level;  ///< instances on the way
  size_t order;    ///< by which it was met
};

bool is_before(const Place& a, const Place& b) {
  return a.level != b.level ? a.level < b.level : a.order < b.order;
}

/// By scene, the last place in each first.
bool is_before_by_scene(const Place& a, const Place& b) {
  if (a.scene.committed != b.scene.committed) {
    return std::less<const CommittedScene*>()(a.scene.committed, b.scene.committed);
  }
  return a.level != b.level ? a.level > b.level : a.order < b.order;
}

/// Keeps one place of each scene: the first on the highest level. In the order of places.
Array<Place> unique_places(Array<Place> places) {
  std::sort(places.begin(), places.end(), is_before_by_scene);
  Place* const end = std::unique(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return a.scene.committed == b.scene.committed;
  });
  places.shrink(static_cast<size_t>(end - places.begin()));
  std::sort(places.begin(), places.end(), is_before);
  return places;
}

}  // namespace

Array<GeometryToSave> geometries_of(const SceneToSave& scene, Memory& memory) {
  const std::span<const CommittedGeometry> committed = scene.committed->geometries();
  const std::span<const Scene::Slot> slots = scene.scene->slots();
  const size_t count = std::max<size_t>(
      slots.size(), committed.empty() ? 0 : size_t{committed.back().geometry_id} + 1);
  Array<GeometryToSave> geometries(memory, count);
  size_t next = 0, used = 0;
  for (size_t id = 0; id < count; ++id) {
    GeometryToSave& saved = geometries[id];
    saved = {nullptr, 0, 0};
    const Scene::Slot slot = id < slots.size() ? slots[id] : Scene::Slot{nullptr, true};
    const uint32_t enabled = slot.is_enabled ? uint32_t{kEnabled} : 0;
    if (next < committed.size() && committed[next].geometry_id == id) {
      saved = {committed[next].geometry, kCommitted | enabled, committed[next].mask};
      ++next;
    } else if (slot.geometry) {
      saved = {slot.geometry, enabled, slot.geometry->mask()};
    }
    if (!saved.geometry) continue;
    check_kind(*saved.geometry, id);
    used = id + 1;
  }
  geometries.shrink(used);
  return geometries;
}

Array<SceneToSave> shown_scenes(const SceneToSave& scene, const Array<GeometryToSave>& geometries,
                                Memory& memory) {
  GrowingArray<SceneToSave> shown(memory);
  size_t prototype = 0;
  for (size_t id = 0; id < geometries.size(); ++id) {
    const Geometry* const geometry = geometries[id].geometry;
    if (!geometry || geometry->kind() != GeometryKind::kInstances) continue;
    const Instances& instances = static_cast<const Instances&>(*geometry);
    const bool is_committed = (geometries[id].flags & kCommitted) != 0;
    for (uint32_t i = 0; i < instances.scene_count(); ++i) {
      const Scene& of = instances.scene(i);
      const CommittedScene* const committed =
          is_committed ? &scene.committed->parts().instances().shown(prototype++) : of.committed();
      if (!committed) {
        throw Error(KIWAMI_ERROR_INVALID_STATE,
                    "scene %u of geometry %zu was never committed, expected a successful "
                    "kiwami_scene_commit before it is saved",
                    i, id);
      }
      shown.push_back({&of, committed});
    }
  }
  return shown.take();
}

/// Level by level, so that a scene is looked at once a level and stands behind all that show it.
SceneWalk::SceneWalk(const SceneToSave& root, Memory& memory) {
  GrowingArray<Place> all(memory);
  Array<Place> level(memory, 1);
  level[0] = {root, 0, 0};
  for (uint32_t depth = 0; !level.empty(); ++depth) {
    if (depth > KIWAMI_MAX_INSTANCE_DEPTH) {
      throw Error(KIWAMI_ERROR_TOO_LARGE,
                  "paths of more than %d instances lead through geometries that are attached, "
                  "expected at most as many",
                  KIWAMI_MAX_INSTANCE_DEPTH);
    }
    GrowingArray<Place> next(memory);
    for (const Place& place : level) {
      all.push_back(place);
      const Array<GeometryToSave> geometries = geometries_of(place.scene, memory);
      for (const SceneToSave& shown : shown_scenes(place.scene, geometries, memory)) {
        next.push_back({shown, depth + 1, next.size()});
      }
    }
    level = unique_places(next.take());
  }
  const Array<Place> places = unique_places(all.take());
  scenes_ = Array<SceneToSave>(memory, places.size());
  numbers_ = Array<Number>(memory, places.size());
  for (size_t i = 0; i < places.size(); ++i) {
    scenes_[i] = places[i].scene;
    numbers_[i] = {places[i].scene.committed, static_cast<uint32_t>(i)};
  }
  std::sort(numbers_.begin(), numbers_.end(), [](const Number& a, const Number& b) {
    return std::less<const CommittedScene*>()(a.scene, b.scene);
  });
}

uint32_t SceneWalk::number_of(const CommittedScene& scene) const {
  const Number* const found = std::lower_bound(
      numbers_.begin(), numbers_.end(), &scene, [](const Number& a, const CommittedScene* b) {
        return std::less<const CommittedScene*>()(a.scene, b);
      });
  return found->number;
}

}  // namespace kiwami::file
