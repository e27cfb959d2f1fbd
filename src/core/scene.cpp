// SPDX-License-Identifier: Apache-2.0
#include "core/scene.h"

#include <algorithm>
#include <cstdio>
#include <functional>

#include "core/error.h"
#include "core/instances.h"
#include "parallel/progress.h"

namespace kiwami {

namespace {

/// How much of a commit is done after a refit, which may turn out to need a build.
constexpr double kRefitted = 0.9;

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
  for (size_t id = 0; id < slots_.size(); ++id) {
    if (slots_[id].geometry) slots_[id].geometry->release();
  }
}

/// A cycle is closed by an attachment or a replacement: what a geometry shows never changes, so until then the
/// scenes below it are a graph without any. They are looked at level by level, each once a level.
void Scene::check_no_cycle(const Geometry& geometry) const {
  if (geometry.kind() != GeometryKind::kInstances) return;
  const auto add_scenes = [](const Geometry& shown, GrowingArray<const Scene*>& scenes) {
    if (shown.kind() != GeometryKind::kInstances) return;
    const auto& instances = static_cast<const Instances&>(shown);
    for (uint32_t i = 0; i < instances.scene_count(); ++i) scenes.push_back(&instances.scene(i));
  };
  GrowingArray<const Scene*> next(device_->memory());
  add_scenes(geometry, next);
  while (!next.empty()) {
    const Array<const Scene*> level = next.take();
    Array<const Scene*> sorted(device_->memory(), level.size());
    std::copy(level.begin(), level.end(), sorted.begin());
    std::sort(sorted.begin(), sorted.end(), std::less<const Scene*>());
    const Scene* previous = nullptr;
    for (const Scene* scene : sorted) {
      if (scene == this) {
        throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                    "geometry shows the scene that it is attached to, expected no cycle of "
                    "instances");
      }
      if (scene == previous) continue;
      previous = scene;
      for (size_t id = 0; id < scene->slots_.size(); ++id) {
        if (scene->slots_[id].geometry) add_scenes(*scene->slots_[id].geometry, next);
      }
    }
  }
}

uint32_t Scene::attach(Geometry& geometry) {
  check_no_cycle(geometry);
  while (lowest_free_ < slots_.size() && slots_[lowest_free_].geometry) ++lowest_free_;
  if (lowest_free_ == slots_.size()) slots_.push_back({nullptr, true});
  slots_[lowest_free_] = {&geometry, true};
  geometry.retain();
  return lowest_free_++;
}

Scene::Slot& Scene::slot(uint32_t geometry_id) {
  if (geometry_id >= slots_.size() || !slots_[geometry_id].geometry) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "geometry_id is %u, expected the number of an attached geometry", geometry_id);
  }
  return slots_[geometry_id];
}

void Scene::detach(uint32_t geometry_id) {
  Slot& left = slot(geometry_id);
  left.geometry->release();
  left.geometry = nullptr;
  lowest_free_ = std::min(lowest_free_, geometry_id);
}

void Scene::replace(uint32_t geometry_id, Geometry& geometry) {
  Slot& place = slot(geometry_id);
  check_no_cycle(geometry);
  geometry.retain();
  place.geometry->release();
  place.geometry = &geometry;
}

void Scene::enable(uint32_t geometry_id, bool is_enabled) {
  slot(geometry_id).is_enabled = is_enabled;
}

Array<AttachedGeometry> Scene::attached_geometries() const {
  Array<AttachedGeometry> attached(device_->memory(), slots_.size());
  size_t count = 0;
  for (size_t id = 0; id < slots_.size(); ++id) {
    if (!slots_[id].geometry || !slots_[id].is_enabled) continue;
    attached[count++] = {slots_[id].geometry, static_cast<uint32_t>(id)};
  }
  attached.shrink(count);
  return attached;
}

void Scene::attach_as(uint32_t geometry_id, Geometry& geometry) {
  while (slots_.size() <= geometry_id) slots_.push_back({nullptr, true});
  slots_[geometry_id] = {&geometry, true};
  geometry.retain();
}

void Scene::restore(const SavedScene& saved) {
  const Array<AttachedGeometry> attached = attached_geometries();
  committed_ = Reference<CommittedScene>::adopt(make_object<CommittedScene>(
      device_->memory(), *device_, attached.data(), attached.size(), saved));
  retired_ = {};
}

template <typename Run>
void Scene::watch(Run&& run) {
  if (!progress_) {
    run(device_->parallel());
    return;
  }
  Progress progress(progress_, progress_user_);
  const Parallel parallel(device_->parallel(), progress);
  run(parallel);
}

void Scene::commit() {
  watch([this](const Parallel& parallel) { build(false, parallel); });
}

/// What was committed by the same parameters with a tree for each mesh; else nullptr.
const CommittedScene* Scene::sharable() const {
  const bool is_same = committed_.get() && parameters_ == committed_parameters_;
  return is_same && !committed_->meshes().empty() ? committed_.get() : nullptr;
}

void Scene::build(bool refits, const Parallel& parallel) {
  Memory& memory = device_->memory();
  const Array<AttachedGeometry> attached = attached_geometries();
  const std::span<const RepresentativeRay> rays(rays_.data(), rays_.size());
  const bool is_two_level = parameters_.whole(KIWAMI_PARAMETER_TWO_LEVEL) != 0;
  Reference<CommittedScene> built = Reference<CommittedScene>::adopt(
      is_two_level ? make_object<CommittedScene>(memory, *device_, attached.data(), attached.size(),
                                                 parameters_, rays, sharable(), refits, parallel)
                   : make_object<CommittedScene>(memory, *device_, attached.data(), attached.size(),
                                                 parameters_, rays, parallel));
  parallel.finish();
  committed_ = std::move(built);
  committed_parameters_ = parameters_;
  retired_ = {};
  log_skipped(*device_, committed_->info());
}

/// A structure with the committed tree that nobody else holds.
Reference<CommittedScene> Scene::take_refittable(const Parallel& parallel) {
  Reference<CommittedScene> taken;
  std::swap(taken, retired_);
  if (taken.get() && !taken->is_shared()) return taken;
  return Reference<CommittedScene>::adopt(
      make_object<CommittedScene>(device_->memory(), *committed_, parallel));
}

void Scene::refit() {
  watch([this](const Parallel& parallel) { refit(parallel); });
}

void Scene::refit(const Parallel& parallel) {
  const Array<AttachedGeometry> attached = attached_geometries();
  const bool is_two_level = parameters_.whole(KIWAMI_PARAMETER_TWO_LEVEL) != 0;
  if (!committed_.get() || is_two_level || !committed_->fits(attached.data(), attached.size())) {
    build(true, parallel);
    return;
  }
  parallel.begin_stage(kRefitted, 0);
  const Reference<CommittedScene> moved = take_refittable(parallel);
  const uint64_t refit_count = committed_->info().refit_count + 1;
  if (!moved->refit(attached.data(), attached.size(), refit_count, parallel)) {
    build(true, parallel);
    return;
  }
  parallel.finish();
  retired_ = committed_;
  committed_ = moved;
  log_skipped(*device_, committed_->info());
}

}  // namespace kiwami
