// SPDX-License-Identifier: Apache-2.0
// The scenes that go into a file: the one that is saved, and those that its instances show.
#pragma once

#include <span>

#include "core/scene.h"

namespace kiwami::file {

/// A scene, and what it is in the file: what it had committed when those committed that show it.
struct SceneToSave {
  const Scene* scene;
  const CommittedScene* committed;
};

/// A geometry that goes into the file.
struct GeometryToSave {
  const Geometry* geometry;  ///< nullptr: the number is free
  uint32_t flags;            ///< kCommitted, kEnabled
  uint32_t mask;
};

/// What a scene committed, by rising geometry id, and what is attached to it in numbers that were
/// free by then. Throws Error(INVALID_STATE) for geometries that files cannot hold.
Array<GeometryToSave> geometries_of(const SceneToSave& scene, Memory& memory);

/// The scenes that the geometries show, in their order. Throws Error(INVALID_STATE) for one that
/// was never committed.
Array<SceneToSave> shown_scenes(const SceneToSave& scene, const Array<GeometryToSave>& geometries,
                                Memory& memory);

/// All scenes, each once however often it is shown, numbered so that those that show it come first.
/// Equal scenes have equal numbers.
class SceneWalk {
 public:
  /// Throws Error(INVALID_STATE, TOO_LARGE or OUT_OF_MEMORY).
  SceneWalk(const SceneToSave& root, Memory& memory);

  std::span<const SceneToSave> scenes() const { return {scenes_.data(), scenes_.size()}; }
  uint32_t number_of(const CommittedScene& scene) const;

 private:
  struct Number {
    const CommittedScene* scene;
    uint32_t number;
  };

  Array<SceneToSave> scenes_;
  Array<Number> numbers_;  ///< by address
};

}  // namespace kiwami::file
