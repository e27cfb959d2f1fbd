// SPDX-License-Identifier: Apache-2.0
// The meshes of a committed scene that have a tree each (KIWAMI_PARAMETER_TWO_LEVEL): a part of it.
#pragma once

#include <span>

#include "bvh/representative_rays.h"
#include "core/geometry.h"
#include "core/memory.h"
#include "core/part_tree.h"
#include "core/scene_parameters.h"
#include "parallel/parallel.h"
#include "wide/mesh_part.h"

namespace kiwami {

class CommittedScene;
struct SavedParts;

/// A committed scene of each mesh, and the tree over their boxes. Successive commits share the
/// scenes of meshes that have not changed.
class SceneMeshes {
 public:
  /// What a commit makes of the meshes.
  struct Input {
    Device& device;
    const AttachedGeometry* geometries;  ///< by rising id; others than meshes are left out
    size_t count;
    const SceneParameters& parameters;
    std::span<const RepresentativeRay> rays;
    uint32_t width;
    const SceneMeshes* before;  ///< by the same parameters; nullptr: none
    bool refits;                ///< changed meshes keep their trees where these fit
  };

  SceneMeshes() = default;
  ~SceneMeshes();
  SceneMeshes(const SceneMeshes&) = delete;
  SceneMeshes& operator=(const SceneMeshes&) = delete;

  /// Throws Error.
  void build(const Input& input, Memory& memory, const Parallel& parallel);

  /// The same, with trees that were saved. Throws Error(INVALID_FILE) where there are too few or
  /// too many of them.
  void restore(Device& device, const AttachedGeometry* geometries, size_t count, FileImage& image,
               const SavedParts& saved, Memory& memory);

  bool empty() const { return entries_.empty(); }
  size_t count() const { return entries_.size(); }
  /// Of a mesh, by rising geometry_id.
  const CommittedScene& scene(size_t mesh) const { return *entries_[mesh].scene; }
  const PartTree& tree() const { return tree_; }
  ScenePart view() const;
  /// Adds what the scenes of the meshes are made of, to info of none.
  void describe(kiwami_scene_info& info) const;

  /// Throws Error(VALIDATION).
  void validate(Memory& memory) const;

 private:
  struct Entry {
    CommittedScene* scene;  ///< a reference
    const Geometry* geometry;
    uint64_t version;  ///< of the geometry
    uint32_t geometry_id;
  };
  class Builder;

  void show(Memory& memory);
  const Entry* find(uint32_t geometry_id) const;
  Array<BuildPrimitive> boxes(Memory& memory) const;

  Array<Entry> entries_;  ///< by rising geometry_id
  Array<const SceneView*> views_;
  PartTree tree_;
  MeshPart data_{};
};

}  // namespace kiwami
