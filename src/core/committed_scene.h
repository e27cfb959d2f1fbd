// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "bvh/representative_rays.h"
#include "bvh/triangle_source.h"
#include "core/device.h"
#include "core/file_image.h"
#include "core/geometry.h"
#include "core/memory.h"
#include "core/object.h"
#include "core/saved_scene.h"
#include "core/scene_meshes.h"
#include "core/scene_opacities.h"
#include "core/scene_parameters.h"
#include "core/scene_parts.h"
#include "kernels/kernel_table.h"
#include "wide/wide_tree.h"

namespace kiwami {

/// A geometry as it was when its scene was committed.
struct CommittedGeometry {
  Geometry* geometry;
  uint32_t geometry_id;
  uint32_t mask;
};

/// What a commit makes and the kernels read: the tree and the tables around it. Holds the
/// geometries that it was built from, so that it outlives their detachment, and their vertices, so
/// that it outlives these. Never changes while anybody holds it but the scene that makes it.
class CommittedScene : public Object<CommittedScene> {
 public:
  /// Builds over count geometries by rising geometry_id. Where a method goes by rays, it goes by
  /// these, or by sampled ones where there are none. Runs and reports its tasks on parallel. Throws
  /// Error.
  CommittedScene(Device& device, const AttachedGeometry* geometries, size_t count,
                 const SceneParameters& parameters, std::span<const RepresentativeRay> rays,
                 const Parallel& parallel);
  /// The same with a tree for each mesh. What has not changed is shared with before, which is
  /// nullptr or made by the same parameters; refits says whether changed meshes keep their trees.
  CommittedScene(Device& device, const AttachedGeometry* geometries, size_t count,
                 const SceneParameters& parameters, std::span<const RepresentativeRay> rays,
                 const CommittedScene* before, bool refits, const Parallel& parallel);
  /// Of count geometries by rising geometry_id, whose trees were saved. The scenes that instances
  /// among them show are committed. Throws Error.
  CommittedScene(Device& device, const AttachedGeometry* geometries, size_t count,
                 const SavedScene& saved);
  /// A copy, to be refitted.
  CommittedScene(const CommittedScene& other, const Parallel& parallel);
  static void destroy(CommittedScene* scene) noexcept;

  /// Whether a refit can give the tree to these geometries, by rising geometry_id: it has a place
  /// for each of their triangles that can be hit. Throws Error(INVALID_ARGUMENT) for an index at or
  /// beyond its mesh's vertex count.
  bool fits(const AttachedGeometry* geometries, size_t count) const;

  /// Moves the tree to where these geometries, which it fits, have their vertices now. Nobody else
  /// may hold it. False: the tree has no room for what has become of the triangles. Then, as after
  /// an exception, it is of no use until a refit succeeds. refit_count is that of its info.
  bool refit(const AttachedGeometry* geometries, size_t count, uint64_t refit_count,
             const Parallel& parallel);

  /// For what only works on it, and is gone before it.
  Memory& memory() const { return device_->memory(); }
  const SceneView& view() const { return view_; }
  const TraversalKernels& kernels() const { return kernels_; }
  /// Whether the scene is one that the plain kernels know.
  bool is_plain() const { return view_.part_count == 0 && !view_.opacities; }
  const Parallel& parallel() const { return device_->parallel(); }
  bool validates_arguments() const { return device_->validates_arguments(); }
  const kiwami_scene_info& info() const { return info_; }
  const WideTree& tree() const { return tree_; }
  uint32_t width() const { return tree_.width; }
  /// Of all that can be hit; empty where there is nothing.
  Bounds bounds() const {
    const float* lower = info_.bounds_min;
    const float* upper = info_.bounds_max;
    return {{lower[0], lower[1], lower[2]}, {upper[0], upper[1], upper[2]}};
  }
  /// Shapes and user primitives have less than triangles: their distance alone is rounded.
  HitError hit_error() const;
  /// About how much a ray may meet.
  uint64_t primitive_count() const {
    const size_t triangles = meshes_.empty() ? triangle_count_ : numbered_count_;
    return triangles + parts_.primitive_count() + parts_.instances().count();
  }
  /// The instances on the longest path to a hit.
  uint32_t instance_depth() const { return parts_.instances().depth(); }
  /// Those that have a tree each; empty where one tree holds all.
  const SceneMeshes& meshes() const { return meshes_; }
  const SceneParts& parts() const { return parts_; }
  /// By rising geometry_id.
  std::span<const CommittedGeometry> geometries() const { return references_.geometries(); }
  /// Of a mesh of source(); nullptr: it has none.
  const OpacityMap* opacity_of(size_t mesh) const { return opacities_.map_of(mesh); }
  /// Of what the tree, or the trees of meshes, hold.
  const Bounds& tree_bounds() const { return tree_bounds_; }
  /// What it holds beside geometries and the scenes of meshes.
  size_t own_bytes() const { return memory_.bytes_in_use() + sizeof(*this); }
  /// Triangles of all meshes, skipped ones included.
  size_t numbered_count() const { return numbered_count_; }
  TriangleSource source() const {
    return {mesh_views_.data(), static_cast<uint32_t>(mesh_views_.size())};
  }

  /// Checks every invariant; throws Error(VALIDATION) or Error(OUT_OF_MEMORY).
  void validate() const;

 private:
  /// Counted references to the geometries and to the vertices that they have at the moment.
  class GeometryReferences {
   public:
    GeometryReferences(Memory& memory, const AttachedGeometry* geometries, size_t count);
    ~GeometryReferences();
    GeometryReferences(const GeometryReferences&) = delete;
    GeometryReferences& operator=(const GeometryReferences&) = delete;
    void swap(GeometryReferences& other) noexcept;

    /// The bytes of their copied buffers, each geometry counted once however often it is attached.
    size_t copied_bytes() const;
    std::span<const CommittedGeometry> geometries() const {
      return {geometries_.data(), geometries_.size()};
    }

   private:
    Array<CommittedGeometry> geometries_;  ///< by rising geometry_id
    Array<uint32_t> by_address_;           ///< their indices
    Array<BufferCopy*> buffers_;           ///< nullptr: the geometry has none
  };

  void number_triangles(const AttachedGeometry* geometries, size_t count);
  BinaryBvh build_binary(Array<BuildPrimitive> primitives, std::span<const RepresentativeRay> rays,
                         const SceneParameters& parameters, const Parallel& parallel);
  void build(const SceneParameters& parameters, std::span<const RepresentativeRay> rays,
             const Parallel& parallel);
  void show_tree(const Bounds& bounds);
  /// Puts the parts into the view, which points to them.
  void show_parts();
  void describe();
  bool can_skipped_be_hit(const AttachedGeometry* geometries, size_t count) const;

  Reference<Device> device_;
  Reference<FileImage> image_;  ///< of a scene that was loaded
  // Its own byte count, which gives the exact peak of one build, whatever else the device does.
  mutable Memory memory_;
  TraversalKernels kernels_{};
  GeometryReferences references_;
  Array<TriangleMeshView> mesh_views_;
  Array<GeometryRange> ranges_;
  SceneOpacities opacities_;
  WideTree tree_;
  SceneMeshes meshes_;
  SceneParts parts_;
  SceneView view_{};
  Bounds tree_bounds_ = Bounds::empty();
  size_t numbered_count_ = 0;  ///< triangles of all meshes, skipped ones included
  size_t triangle_count_ = 0;
  Array<uint32_t> skipped_ids_;  ///< of triangles that had no place in the tree when it was built
  double node_cost_ = 0.0, leaf_cost_ = 0.0;
  bool validates_build_ = false;
  kiwami_scene_info info_{};
};

}  // namespace kiwami
