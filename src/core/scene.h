// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/committed_scene.h"
#include "core/device.h"
#include "core/geometry.h"
#include "core/object.h"
#include "core/scene_parameters.h"

namespace kiwami {

/// Geometries and parameters that may change, and the structure that the last commit made of them.
class Scene : public Object<Scene> {
 public:
  static Scene* create(Device& device);
  static void destroy(Scene* scene) noexcept;

  explicit Scene(Device& device) : device_(device), geometries_(device.memory()) {}
  ~Scene();

  Device& device() const { return *device_; }
  SceneParameters& parameters() { return parameters_; }
  const SceneParameters& parameters() const { return parameters_; }

  /// For what goes by rays in the next commits; empty: rays are sampled.
  void set_representative_rays(Array<RepresentativeRay> rays) { rays_ = std::move(rays); }

  /// Returns the lowest free number. Throws Error(OUT_OF_MEMORY).
  uint32_t attach(Geometry& geometry);
  /// Throws Error(INVALID_ARGUMENT) for a number that no geometry has.
  void detach(uint32_t geometry_id);

  /// Attaches a geometry by a number that is free. Throws Error(OUT_OF_MEMORY).
  void attach_as(uint32_t geometry_id, Geometry& geometry);

  /// Throws Error, and then keeps what was committed before.
  void commit();
  /// Takes the place of a commit: a structure that was saved, of the attached geometries.
  void restore(SavedTree saved);
  /// nullptr before the first commit.
  CommittedScene* committed() const { return committed_.get(); }

 private:
  Array<AttachedGeometry> attached_geometries() const;

  Reference<Device> device_;
  SceneParameters parameters_;
  Array<RepresentativeRay> rays_;
  GrowingArray<Geometry*> geometries_;  ///< by geometry id; nullptr: free
  uint32_t lowest_free_ = 0;            ///< every lower id is taken
  Reference<CommittedScene> committed_;
};

}  // namespace kiwami
