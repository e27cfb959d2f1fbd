// SPDX-License-Identifier: Apache-2.0
#include "core/binary_tree.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "core/binary_trace.h"
#include "core/error.h"
#include "core/trace.h"
#include "math/float_environment.h"
#include "math/rounding.h"

namespace kiwami {
namespace {

/// Rays that one task traces.
constexpr size_t kBlockSize = 1024;

Vec3f centre_of(const Array<kiwami_bvh_node>& nodes) {
  Vec3f centre{0.0f, 0.0f, 0.0f};
  if (nodes.empty()) return centre;
  for (int axis = 0; axis < 3; ++axis) {
    centre[axis] = 0.5f * nodes[0].lower[axis] + 0.5f * nodes[0].upper[axis];
  }
  return centre;
}

Array<uint32_t> copy_of(const Array<uint32_t>& ids, Memory& memory) {
  Array<uint32_t> copy(memory, ids.size());
  std::copy(ids.begin(), ids.end(), copy.begin());
  return copy;
}

void check_kind(const Bvh& bvh) {
  if (!bvh.mesh()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "bvh is the tree of a scene, or one over boxes, expected one of kiwami_bvh_build "
                "over a mesh");
  }
  if (bvh.info().width != 2) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "bvh has the width %u, expected 2",
                bvh.info().width);
  }
  if (bvh.info().leaf_width > kBinaryBlockWidth) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "bvh has up to %u triangles a leaf, expected at most %d", bvh.info().leaf_width,
                kBinaryBlockWidth);
  }
}

}  // namespace

BinaryTree* BinaryTree::create(const Bvh& bvh, uint32_t layout) {
  const DefaultFloatEnvironment environment;
  check_kind(bvh);
  return make_object<BinaryTree>(bvh.device().memory(), bvh, layout);
}

void BinaryTree::destroy(BinaryTree* tree) noexcept {
  const Reference<Device> device = tree->device_;
  destroy_object(device->memory(), tree);
}

BinaryTree::BinaryTree(const Bvh& bvh, uint32_t layout)
    : device_(bvh.device()),
      mesh_(*bvh.mesh()),
      vertices_(bvh.mesh_vertices()),
      mesh_view_(*bvh.source().meshes),
      range_{0, 0, mesh_view_.mask},
      skipped_ids_(copy_of(bvh.skipped_ids(), bvh.device().memory())),
      layout_(layout),
      // Spatial splits make a triangle stand in several leaves.
      has_duplicates_(bvh.primitive_count() + bvh.info().skipped_count > mesh_view_.triangle_count),
      primitive_count_(bvh.primitive_count()) {
  Memory& memory = device_->memory();
  const FlatBinary flat{bvh.nodes(), bvh.primitive_ids(), centre_of(bvh.nodes())};
  const bool has_boxes = layout == KIWAMI_BINARY_LAYOUT_BOXES;
  tree_ = has_boxes ? box_layout(flat, memory) : dual_split_layout(flat, memory);
  view_.boxes = tree_.boxes.data();
  view_.nodes = tree_.nodes.data();
  view_.node_count = static_cast<uint32_t>(tree_.node_count());
  SceneView& scene = view_.scene;
  scene.ranges = &range_;
  scene.range_count = 1;
  scene.has_masks = mesh_view_.mask != ~uint32_t{0} ? 1 : 0;
  scene.meshes = &mesh_view_;
  scene.tree.memory = reinterpret_cast<const unsigned char*>(tree_.blocks.data());
  scene.tree.memory_bytes = tree_.blocks.bytes();
  scene.tree.leaf_layout = LeafLayout::kIndices;
  scene.tree.has_duplicates = has_duplicates_ ? 1 : 0;
  scene.tree.centre = flat.centre;
  for (int axis = 0; axis < 3; ++axis) {
    view_.bounds[axis][0] = tree_.bounds.lower[axis];
    view_.bounds[axis][1] = tree_.bounds.upper[axis];
    scene.tree.greatest_bound[axis] =
        tree_.node_count() == 0
            ? 0.0f
            : std::max(std::fabs(tree_.bounds.lower[axis]), std::fabs(tree_.bounds.upper[axis]));
  }
}

kiwami_binary_tree_info BinaryTree::info() const {
  kiwami_binary_tree_info info{};
  info.layout = layout_;
  info.node_count = tree_.node_count();
  info.split_count = tree_.split_count;
  info.carve_count = tree_.carve_count;
  info.leaf_count = tree_.blocks.size();
  info.primitive_count = primitive_count_;
  info.node_bytes = tree_.node_bytes();
  info.bytes = sizeof *this + tree_.node_bytes() + tree_.blocks.bytes() + skipped_ids_.bytes();
  return info;
}

void BinaryTree::validate() const {
  const DefaultFloatEnvironment environment;
  Memory& memory = device_->memory();
  Array<Bounds> boxes(memory, mesh_view_.triangle_count);
  const Vec3f centre = view_.scene.tree.centre;
  device_->parallel().for_blocks(boxes.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Vec3f corner[3];
      mesh_view_.corners_of(static_cast<uint32_t>(i), corner);
      boxes[i] = Bounds::empty();
      for (const Vec3f& at : corner) {
        for (int axis = 0; axis < 3; ++axis) {
          boxes[i].lower[axis] =
              min_keep(boxes[i].lower[axis], subtract_down(at[axis], centre[axis]));
          boxes[i].upper[axis] =
              max_keep(boxes[i].upper[axis], subtract_up(at[axis], centre[axis]));
        }
      }
    }
  });
  for (const uint32_t id : skipped_ids_) boxes[id] = Bounds::empty();
  verify_binary_layout(tree_, {boxes, has_duplicates_}, memory);
}

BinaryTreeCounters BinaryTree::trace(const RayBatch& batch) const {
  const auto trace_all =
      layout_ == KIWAMI_BINARY_LAYOUT_BOXES ? kiwami::trace_boxes : kiwami::trace_dual_split;
  const Parallel& parallel = device_->parallel();
  BinaryTreeCounters counters{0, 0, 0};
  if (is_alone(parallel, batch.count, false)) {
    const DefaultFloatEnvironment environment;
    trace_all(view_, batch, counters);
    return counters;
  }
  std::atomic<uint64_t> nodes{0}, planes{0}, leaves{0};
  parallel.for_blocks(batch.count, kBlockSize, [&](size_t begin, size_t end) {
    BinaryTreeCounters own{0, 0, 0};
    trace_all(view_,
              {batch.rays + begin * batch.ray_stride, batch.ray_stride,
               batch.answers + begin * batch.answer_stride, batch.answer_stride, end - begin},
              own);
    nodes.fetch_add(own.node_visits, std::memory_order_relaxed);
    planes.fetch_add(own.plane_tests, std::memory_order_relaxed);
    leaves.fetch_add(own.leaf_visits, std::memory_order_relaxed);
  });
  return {nodes.load(), planes.load(), leaves.load()};
}

}  // namespace kiwami
