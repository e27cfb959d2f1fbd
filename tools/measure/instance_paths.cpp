// SPDX-License-Identifier: Apache-2.0
#include "measure/instance_paths.h"

#include <algorithm>

#include "measure/file_geometries.h"
#include "measure/library.h"

namespace kiwami::tools {
namespace {

kiwami_geometry* make_resting(kiwami_device* device, kiwami_scene* shown,
                              const SavedInstances& saved) {
  kiwami_instances_desc desc;
  throw_on_error(kiwami_instances_desc_init(&desc, sizeof desc), device);
  desc.flags = KIWAMI_INSTANCES_SHARE_BUFFERS;
  desc.scenes = &shown;
  desc.scene_count = 1;
  desc.transforms = saved.transforms.data();
  desc.count = saved.shown.size();
  kiwami_geometry* geometry = nullptr;
  throw_on_error(kiwami_instances_create(device, &desc, &geometry), device);
  return geometry;
}

kiwami_geometry* make_moving(kiwami_device* device, kiwami_scene* shown,
                             const SavedInstances& saved) {
  kiwami_moving_instances_desc desc;
  throw_on_error(kiwami_moving_instances_desc_init(&desc, sizeof desc), device);
  desc.flags = KIWAMI_INSTANCES_SHARE_BUFFERS;
  desc.scenes = &shown;
  desc.scene_count = 1;
  desc.format = saved.has_quaternions ? KIWAMI_TRANSFORM_QUATERNION : KIWAMI_TRANSFORM_MATRIX;
  desc.transforms = saved.transforms.data();
  desc.transform_stride = saved.has_quaternions ? sizeof(kiwami_quaternion_transform) : 48;
  desc.count = saved.shown.size();
  desc.step_stride = desc.count * desc.transform_stride;
  desc.step_count = saved.step_count;
  desc.time_begin = saved.time_begin;
  desc.time_end = saved.time_end;
  kiwami_geometry* geometry = nullptr;
  throw_on_error(kiwami_moving_instances_create(device, &desc, &geometry), device);
  return geometry;
}

}  // namespace

InstancePaths::InstancePaths(kiwami_device* device, const SceneFile& file)
    : scenes_(file.saved_instances.size()) {
  // Their transforms alone are asked for, so it does not matter what they show.
  kiwami_scene* nothing = nullptr;
  throw_on_error(kiwami_scene_create(device, &nothing), device);
  try {
    for (size_t i = 0; i < scenes_.size(); ++i) {
      for (const SavedInstances& saved : file.saved_instances[i]) {
        add(device, nothing, saved, scenes_[i]);
      }
    }
  } catch (...) {
    kiwami_scene_release(nothing);
    release();
    throw;
  }
  kiwami_scene_release(nothing);
}

InstancePaths::~InstancePaths() { release(); }

void InstancePaths::add(kiwami_device* device, kiwami_scene* shown, const SavedInstances& saved,
                        std::vector<Array>& arrays) {
  const uint32_t first =
      arrays.empty()
          ? 0
          : arrays.back().first + static_cast<uint32_t>(arrays.back().saved->shown.size());
  arrays.push_back({&saved, first, nullptr});
  arrays.back().geometry = saved.step_count == 1 ? make_resting(device, shown, saved)
                                                 : make_moving(device, shown, saved);
}

void InstancePaths::release() {
  for (const std::vector<Array>& arrays : scenes_) {
    for (const Array& array : arrays) kiwami_geometry_release(array.geometry);
  }
}

void InstancePaths::move_to_world(const uint32_t* path, float time, kiwami_hit& hit) const {
  std::array<float, 12> matrices[KIWAMI_MAX_INSTANCE_DEPTH];
  size_t depth = 0;
  for (uint32_t scene = 0; depth < KIWAMI_MAX_INSTANCE_DEPTH; ++depth) {
    const uint32_t number = path[depth];
    if (number == KIWAMI_INVALID_ID) break;
    const std::vector<Array>& arrays = scenes_[scene];
    const Array& array =
        *(std::upper_bound(arrays.begin(), arrays.end(), number,
                           [](uint32_t a, const Array& b) { return a < b.first; }) -
          1);
    throw_on_error(kiwami_instances_transform(array.geometry, number - array.first, time,
                                              matrices[depth].data()),
                   nullptr);
    scene = array.saved->shown[number - array.first];
  }
  if (depth == 0) return;
  while (depth != 0) tools::move_to_world(matrices[--depth], hit);
  hit.geometry_id = path[0];
}

}  // namespace kiwami::tools
