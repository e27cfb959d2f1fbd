// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstring>

#include "core/committed_scene.h"
#include "core/device.h"
#include "core/object.h"
#include "core/triangle_mesh.h"
#include "kiwami/bvh.h"
#include "wide/flat_tree.h"

namespace kiwami {

/// Boxes of the caller, six floats each, at any address.
struct BoxArray {
  const unsigned char* data;
  size_t stride;
  size_t count;

  Bounds operator[](size_t index) const {
    Bounds box;
    std::memcpy(&box, data + index * stride, sizeof box);
    return box;
  }
};

/// A tree to build: over boxes, or over a mesh if there is one.
struct BvhPlan {
  uint32_t width;  ///< 2, 4, 8 or 16
  BoxArray boxes;
  TriangleMesh* mesh;
  SceneParameters parameters;
};

/// What a file holds of a tree that was built.
struct SavedBvh {
  uint32_t width;
  uint32_t leaf_width;
  double build_seconds;
  FlatTree tree;
  Array<uint32_t> skipped_ids;  ///< rising
  Array<Bounds> boxes;          ///< of a tree over boxes; those that were skipped are empty
  Reference<TriangleMesh> mesh;
};

/// What a tree costs, and what each node adds to that.
struct BvhMeasures {
  kiwami_bvh_measures totals;
  Array<kiwami_bvh_node_measures> nodes;
};

/// A tree to look at: flat nodes, and the ids of the primitives in their order.
class Bvh : public Object<Bvh> {
 public:
  /// The tree of a committed scene, which it holds for its triangles. Throws Error(TOO_LARGE or
  /// OUT_OF_MEMORY).
  static Bvh* create(Device& device, CommittedScene& scene);
  /// Builds a tree. Throws Error.
  static Bvh* create(Device& device, const BvhPlan& plan);
  /// One that was saved; nothing of it is checked. Throws Error(OUT_OF_MEMORY).
  static Bvh* create(Device& device, SavedBvh saved);
  static void destroy(Bvh* bvh) noexcept;

  Bvh(Device& device, CommittedScene& scene);
  Bvh(Device& device, const BvhPlan& plan);
  Bvh(Device& device, SavedBvh saved);

  Device& device() const { return *device_; }
  const kiwami_bvh_info& info() const { return info_; }
  const Array<kiwami_bvh_node>& nodes() const { return tree_.nodes; }
  size_t primitive_count() const { return tree_.primitive_ids.size(); }
  kiwami_bvh_primitive primitive(size_t position) const;

  /// struct_size of the totals is 0. Throws Error(OUT_OF_MEMORY).
  BvhMeasures measure(const kiwami_bvh_measure_desc& desc) const;

  /// Gives the nodes the boxes of moved primitives; the boxes are not read for a tree over a mesh.
  /// Throws Error, and then nothing has changed.
  void refit(const BoxArray& boxes);

  /// Checks every invariant; throws Error(VALIDATION) or Error(OUT_OF_MEMORY).
  void validate() const;

  bool is_over_boxes() const { return !scene_.get() && !mesh_.get(); }
  bool is_of_scene() const { return scene_.get() != nullptr; }
  /// What a tree was built over, or null: the mesh, and the vertices that it had if they were
  /// copied.
  TriangleMesh* mesh() const { return mesh_.get(); }
  const Reference<BufferCopy>& mesh_vertices() const { return mesh_vertices_; }
  /// What a file holds of it.
  TriangleSource source() const;
  const Array<uint32_t>& primitive_ids() const { return tree_.primitive_ids; }
  const Array<uint32_t>& skipped_ids() const { return skipped_ids_; }
  const Array<Bounds>& boxes() const { return boxes_; }

 private:
  Array<BuildPrimitive> collect(const TriangleSource& source) const;
  void build(Array<BuildPrimitive> primitives, const BvhPlan& plan);
  Array<Bounds> boxes_by_id(const TriangleSource& source) const;
  void describe(uint32_t width, uint32_t leaf_width);
  void take_vertices();

  Reference<Device> device_;
  Reference<CommittedScene> scene_;
  Reference<TriangleMesh> mesh_;
  Reference<BufferCopy> mesh_vertices_;  ///< what mesh_view_ reads of copied vertices
  TriangleMeshView mesh_view_{};
  Array<Bounds> boxes_;          ///< by primitive id, of a tree over boxes
  size_t numbered_count_;        ///< primitives, skipped ones included
  Array<uint32_t> skipped_ids_;  ///< left out by the build
  FlatTree tree_;
  kiwami_bvh_info info_{};
};

}  // namespace kiwami
