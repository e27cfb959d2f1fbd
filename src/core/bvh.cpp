// SPDX-License-Identifier: Apache-2.0
#include "core/bvh.h"

#include <algorithm>

#include "bvh/end_point_overlap.h"

namespace kiwami {
namespace {

/// Of a box. In double: a float of the bounds' extent would lose digits over many nodes.
double area_of(const kiwami_bvh_node& node) {
  double extent[3];
  for (int axis = 0; axis < 3; ++axis) {
    extent[axis] = static_cast<double>(node.upper[axis]) - static_cast<double>(node.lower[axis]);
  }
  return 2.0 * (extent[0] * extent[1] + extent[1] * extent[2] + extent[2] * extent[0]);
}

}  // namespace

Bvh* Bvh::create(Device& device, CommittedScene& scene) {
  return make_object<Bvh>(device.memory(), device, scene);
}

Bvh* Bvh::create(Device& device, const BvhPlan& plan) {
  return make_object<Bvh>(device.memory(), device, plan);
}

Bvh* Bvh::create(Device& device, SavedBvh saved) {
  return make_object<Bvh>(device.memory(), device, std::move(saved));
}

void Bvh::destroy(Bvh* bvh) noexcept {
  const Reference<Device> device = bvh->device_;
  destroy_object(device->memory(), bvh);
}

Bvh::Bvh(Device& device, CommittedScene& scene)
    : device_(device),
      scene_(scene),
      numbered_count_(scene.numbered_count()),
      tree_(flatten(scene.tree(), device.memory())) {
  info_.skipped_count = scene.info().skipped_count;
  info_.build_seconds = scene.info().build_seconds;
  describe(scene.tree().width, scene.tree().leaf_width);
}

Bvh::Bvh(Device& device, SavedBvh saved)
    : device_(device),
      mesh_(std::move(saved.mesh)),
      boxes_(std::move(saved.boxes)),
      numbered_count_(boxes_.size()),
      skipped_ids_(std::move(saved.skipped_ids)),
      tree_(std::move(saved.tree)) {
  if (mesh_.get()) {
    mesh_view_ = mesh_->view(0, 0);
    numbered_count_ = mesh_->triangle_count();
  }
  info_.skipped_count = skipped_ids_.size();
  info_.build_seconds = saved.build_seconds;
  describe(saved.width, saved.leaf_width);
}

void Bvh::describe(uint32_t width, uint32_t leaf_width) {
  info_.struct_size = sizeof(info_);
  info_.width = width;
  info_.leaf_width = leaf_width;
  info_.node_count = static_cast<uint32_t>(tree_.nodes.size());
  info_.primitive_count = static_cast<uint32_t>(tree_.primitive_ids.size());
  for (const kiwami_bvh_node& node : tree_.nodes) {
    info_.depth = std::max(info_.depth, node.depth);
    if (node.child_count == 0) ++info_.leaf_count;
  }
  info_.bytes = sizeof(*this) + tree_.nodes.bytes() + tree_.primitive_ids.bytes() + boxes_.bytes() +
                skipped_ids_.bytes();
}

TriangleSource Bvh::source() const {
  if (scene_.get()) return scene_->source();
  if (mesh_.get()) return {&mesh_view_, 1};
  return {nullptr, 0};
}

kiwami_bvh_primitive Bvh::primitive(size_t position) const {
  const uint32_t id = tree_.primitive_ids[position];
  if (is_over_boxes()) return {0, id};
  const TriangleMeshView& mesh = source().mesh_of(id);
  return {mesh.geometry_id, id - mesh.first_id};
}

BvhMeasures Bvh::measure(const kiwami_bvh_measure_desc& desc) const {
  Memory& memory = device_->memory();
  BvhMeasures measures{{}, Array<kiwami_bvh_node_measures>(memory, nodes().size())};
  if (nodes().empty()) return measures;
  EndPointOverlap overlap;
  const bool with_epo = (desc.flags & KIWAMI_MEASURE_WITHOUT_EPO) == 0 && !is_over_boxes();
  if (with_epo) {
    overlap = measure_end_point_overlap({nodes().data(), nodes().size()}, tree_.primitive_ids,
                                        source(), memory, device_->parallel());
  }
  const uint32_t block_size = desc.block_size ? desc.block_size : info_.leaf_width;
  const double root_area = area_of(nodes()[0]);
  kiwami_bvh_measures& totals = measures.totals;
  totals.surface_area = overlap.surface_area;
  for (size_t i = 0; i < nodes().size(); ++i) {
    const kiwami_bvh_node& node = nodes()[i];
    const bool is_leaf = node.child_count == 0;
    const uint32_t tests = (node.primitive_count - 1) / block_size + 1;
    const double cost = is_leaf ? desc.leaf_cost * tests : desc.node_cost;
    const double area = area_of(node);
    const double relative_area = root_area > 0.0 ? area / root_area : 1.0;
    const double epo = with_epo ? cost * overlap.foreign_area[i] : 0.0;
    measures.nodes[i] = {area, cost * relative_area, epo};
    totals.sah += cost * relative_area;
    totals.epo += epo;
    (is_leaf ? totals.leaf_area : totals.node_area) += relative_area;
  }
  return measures;
}

}  // namespace kiwami
