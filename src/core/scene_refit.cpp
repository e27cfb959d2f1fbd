// SPDX-License-Identifier: Apache-2.0
// Committed scenes whose vertices have moved.
#include <chrono>

#include "core/build_primitives.h"
#include "core/committed_scene.h"
#include "core/triangle_mesh.h"
#include "wide/refit_wide.h"

namespace kiwami {

CommittedScene::CommittedScene(const CommittedScene& other, const Parallel& parallel)
    : device_(other.device_),
      memory_(other.memory_.allocator()),
      kernels_(other.kernels_),
      references_(memory_, nullptr, 0),
      tree_(copy_of(other.tree_, memory_, parallel)),
      skipped_ids_(memory_, other.skipped_ids_.size()),
      node_cost_(other.node_cost_),
      leaf_cost_(other.leaf_cost_),
      validates_build_(other.validates_build_),
      info_(other.info_) {
  std::copy(other.skipped_ids_.begin(), other.skipped_ids_.end(), skipped_ids_.begin());
}

bool CommittedScene::fits(const AttachedGeometry* geometries, size_t count) const {
  // What is known of a tree beside its boxes is not in a file; parts that are gone leave no trace.
  if (image_.get() || !meshes_.empty() || view_.part_count != 0) return false;
  size_t next = 0;
  for (size_t i = 0; i < count; ++i) {
    if (geometries[i].geometry->kind() != GeometryKind::kTriangleMesh) return false;
    const TriangleMesh& mesh = static_cast<const TriangleMesh&>(*geometries[i].geometry);
    if (mesh.triangle_count() == 0) continue;
    if (next == mesh_views_.size()) return false;
    const TriangleMeshView& committed = mesh_views_[next++];
    if (committed.geometry_id != geometries[i].geometry_id ||
        committed.triangle_count != mesh.triangle_count()) {
      return false;
    }
  }
  return next == mesh_views_.size() && !can_skipped_be_hit(geometries, count);
}

/// Whether a triangle that has no place in the tree needs one now.
bool CommittedScene::can_skipped_be_hit(const AttachedGeometry* geometries, size_t count) const {
  size_t next = 0, place = 0;
  for (size_t i = 0; i < count && next < skipped_ids_.size(); ++i) {
    const TriangleMesh& mesh = static_cast<const TriangleMesh&>(*geometries[i].geometry);
    if (mesh.triangle_count() == 0) continue;
    const uint32_t first_id = mesh_views_[place++].first_id;
    const TriangleMeshView moved = mesh.view(first_id, geometries[i].geometry_id);
    for (; next < skipped_ids_.size(); ++next) {
      const uint32_t primitive = skipped_ids_[next] - first_id;
      if (primitive >= moved.triangle_count) break;
      Vec3f corner[3];
      moved.checked_corners_of(primitive, corner);
      if (can_be_hit(corner)) return true;
    }
  }
  return false;
}

bool CommittedScene::refit(const AttachedGeometry* geometries, size_t count, uint64_t refit_count,
                           const Parallel& parallel) {
  const auto start = std::chrono::steady_clock::now();
  memory_.reset_peak();
  GeometryReferences references(memory_, geometries, count);
  references_.swap(references);
  number_triangles(geometries, count);
  const RefitResult result =
      refit_wide_tree(tree_, source(), node_cost_, leaf_cost_, memory_, parallel);
  // Blocks of ids alone have no place for the mark of a triangle that has vanished.
  if (result.vanished_lanes != 0 && tree_.leaf_layout == LeafLayout::kIndices) return false;
  triangle_count_ = result.vanished_lanes == 0
                        ? numbered_count_ - skipped_ids_.size()
                        : count_hittable(source(), numbered_count_, memory_, parallel);
  show_tree(result.bounds);
  describe();
  if (validates_build_) validate();
  info_.refit_count = refit_count;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  info_.build_seconds = seconds.count();
  return true;
}

}  // namespace kiwami
