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

  explicit Scene(Device& device) : device_(device), slots_(device.memory()) {}
  ~Scene();

  Device& device() const { return *device_; }
  SceneParameters& parameters() { return parameters_; }
  const SceneParameters& parameters() const { return parameters_; }

  /// For what goes by rays in the next commits; empty: rays are sampled.
  void set_representative_rays(Array<RepresentativeRay> rays) { rays_ = std::move(rays); }

  /// Who is told of the next commits; nullptr: nobody.
  void set_progress(kiwami_progress function, void* user) {
    progress_ = function;
    progress_user_ = user;
  }

  /// Returns the lowest free number. Throws Error(OUT_OF_MEMORY), or Error(INVALID_ARGUMENT) where
  /// the scene would be a part of itself.
  uint32_t attach(Geometry& geometry);
  /// Throws Error(INVALID_ARGUMENT) for a number that no geometry has.
  void detach(uint32_t geometry_id);

  /// Puts another geometry in the place of the one with this number, which throws
  /// Error(INVALID_ARGUMENT) where there is none.
  void replace(uint32_t geometry_id, Geometry& geometry);
  /// Whether the next commits are to see a geometry. Throws Error(INVALID_ARGUMENT) for a number
  /// that no geometry has.
  void enable(uint32_t geometry_id, bool is_enabled);

  /// Attaches a geometry by a number that is free. Throws Error(OUT_OF_MEMORY).
  void attach_as(uint32_t geometry_id, Geometry& geometry);

  /// Throws Error, and then keeps what was committed before.
  void commit();
  /// The same, but keeps the tree where it fits what is attached.
  void refit();
  /// Takes the place of a commit: a structure that was saved, of the enabled geometries.
  void restore(const SavedScene& saved);
  /// nullptr before the first commit.
  CommittedScene* committed() const { return committed_.get(); }

  struct Slot {
    Geometry* geometry;  ///< nullptr: free
    bool is_enabled;
  };
  /// By geometry id.
  std::span<const Slot> slots() const { return {slots_.data(), slots_.size()}; }

 private:
  Slot& slot(uint32_t geometry_id);
  void check_no_cycle(const Geometry& geometry) const;
  Array<AttachedGeometry> attached_geometries() const;
  Reference<CommittedScene> take_refittable(const Parallel& parallel);
  /// Calls run(parallel), whose tasks are told to who wants to know.
  template <typename Run>
  void watch(Run&& run);
  void build(bool refits, const Parallel& parallel);
  const CommittedScene* sharable() const;
  void refit(const Parallel& parallel);

  Reference<Device> device_;
  SceneParameters parameters_;
  SceneParameters committed_parameters_;  ///< of the last commit
  kiwami_progress progress_ = nullptr;
  void* progress_user_ = nullptr;
  Array<RepresentativeRay> rays_;
  GrowingArray<Slot> slots_;  ///< by geometry id
  uint32_t lowest_free_ = 0;  ///< every lower id is taken
  Reference<CommittedScene> committed_;
  // The one before, if the last commit was a refit: the next one moves it, so that moving scenes
  // need no new memory.
  Reference<CommittedScene> retired_;
};

}  // namespace kiwami
