// SPDX-License-Identifier: Apache-2.0
#include "core/scene.h"

#include <algorithm>
#include <cstdio>

#include "core/error.h"

namespace kiwami {

namespace {

void log_skipped(const Device& device, const kiwami_scene_info& info) {
  if (info.skipped_count == 0) return;
  char sentence[Error::kCapacity];
  std::snprintf(
      sentence, sizeof(sentence),
      "commit skipped %llu of %llu triangles for a vertex that is NaN, infinite or beyond "
      "KIWAMI_MAX_COORDINATE",
      static_cast<unsigned long long>(info.skipped_count),
      static_cast<unsigned long long>(info.skipped_count + info.triangle_count));
  device.log(KIWAMI_OK, sentence);
}

}  // namespace

Scene* Scene::create(Device& device) { return make_object<Scene>(device.memory(), device); }

void Scene::destroy(Scene* scene) noexcept {
  const Reference<Device> device = scene->device_;
  destroy_object(device->memory(), scene);
}

Scene::~Scene() {
  for (size_t id = 0; id < geometries_.size(); ++id) {
    if (geometries_[id]) geometries_[id]->release();
  }
}

uint32_t Scene::attach(Geometry& geometry) {
  while (lowest_free_ < geometries_.size() && geometries_[lowest_free_]) ++lowest_free_;
  if (lowest_free_ == geometries_.size()) geometries_.push_back(nullptr);
  geometries_[lowest_free_] = &geometry;
  geometry.retain();
  return lowest_free_++;
}

void Scene::detach(uint32_t geometry_id) {
  if (geometry_id >= geometries_.size() || !geometries_[geometry_id]) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "geometry_id is %u, expected the number of an attached geometry", geometry_id);
  }
  geometries_[geometry_id]->release();
  geometries_[geometry_id] = nullptr;
  lowest_free_ = std::min(lowest_free_, geometry_id);
}

Array<AttachedGeometry> Scene::attached_geometries() const {
  Array<AttachedGeometry> attached(device_->memory(), geometries_.size());
  size_t count = 0;
  for (size_t id = 0; id < geometries_.size(); ++id) {
    if (geometries_[id]) attached[count++] = {geometries_[id], static_cast<uint32_t>(id)};
  }
  attached.shrink(count);
  return attached;
}

void Scene::attach_as(uint32_t geometry_id, Geometry& geometry) {
  while (geometries_.size() <= geometry_id) geometries_.push_back(nullptr);
  geometries_[geometry_id] = &geometry;
  geometry.retain();
}

void Scene::restore(SavedTree saved) {
  const Array<AttachedGeometry> attached = attached_geometries();
  committed_ = Reference<CommittedScene>::adopt(make_object<CommittedScene>(
      device_->memory(), *device_, attached.data(), attached.size(), std::move(saved)));
}

void Scene::commit() {
  Memory& memory = device_->memory();
  const Array<AttachedGeometry> attached = attached_geometries();
  committed_ = Reference<CommittedScene>::adopt(
      make_object<CommittedScene>(memory, *device_, attached.data(), attached.size(), parameters_,
                                  std::span<const RepresentativeRay>(rays_.data(), rays_.size())));
  log_skipped(*device_, committed_->info());
}

}  // namespace kiwami
