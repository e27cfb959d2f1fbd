// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/bvh.h"
#include "kernels/kernel_table.h"
#include "kiwami/binary_tree.h"
#include "wide/binary_layouts.h"

namespace kiwami {

/// A binary tree over a mesh in one of the layouts, for rays to go through. Never changed again.
class BinaryTree : public Object<BinaryTree> {
 public:
  /// Throws Error(INVALID_ARGUMENT) for a tree that is not binary, not over a mesh or with large
  /// leaves, Error(TOO_LARGE or OUT_OF_MEMORY).
  static BinaryTree* create(const Bvh& bvh, uint32_t layout);
  static void destroy(BinaryTree* tree) noexcept;

  BinaryTree(const Bvh& bvh, uint32_t layout);

  Device& device() const { return *device_; }
  kiwami_binary_tree_info info() const;
  /// Throws Error(VALIDATION or OUT_OF_MEMORY).
  void validate() const;
  /// Closest hits, on the device's threads where there are many rays. Returns what was visited.
  BinaryTreeCounters trace(const RayBatch& batch) const;

 private:
  Reference<Device> device_;
  Reference<TriangleMesh> mesh_;
  Reference<BufferCopy> vertices_;  ///< that mesh_view_ reads, if they were copied
  TriangleMeshView mesh_view_;
  GeometryRange range_;
  Array<uint32_t> skipped_ids_;
  uint32_t layout_;
  bool has_duplicates_;
  uint64_t primitive_count_;
  BinaryLayout tree_;
  BinaryTreeView view_{};
};

}  // namespace kiwami
