// SPDX-License-Identifier: Apache-2.0
#include "kiwami/scene.h"

#include "api/check.h"
#include "core/pipeline.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumInfoSize = 8;

void check_fits(const kiwami_scene* scene, kiwami_geometry* geometry) {
  check_not_null(scene, "scene");
  check_not_null(geometry, "geometry");
  if (&object_of(geometry)->device() != &object_of(scene)->device()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "geometry is of another device, expected one of the scene's device");
  }
}

}  // namespace

extern "C" {

kiwami_result kiwami_scene_create(kiwami_device* device, kiwami_scene** scene) {
  if (scene) *scene = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(scene, "scene");
    *scene = reinterpret_cast<kiwami_scene*>(Scene::create(*object_of(device)));
  });
}

void kiwami_scene_retain(kiwami_scene* scene) {
  if (scene) object_of(scene)->retain();
}

void kiwami_scene_release(kiwami_scene* scene) {
  if (scene) object_of(scene)->release();
}

kiwami_result kiwami_scene_attach(kiwami_scene* scene, kiwami_geometry* geometry,
                                  uint32_t* geometry_id) {
  return guarded(device_of(scene), [&] {
    check_fits(scene, geometry);
    const uint32_t id = object_of(scene)->attach(*object_of(geometry));
    if (geometry_id) *geometry_id = id;
  });
}

kiwami_result kiwami_scene_detach(kiwami_scene* scene, uint32_t geometry_id) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    object_of(scene)->detach(geometry_id);
  });
}

kiwami_result kiwami_scene_replace(kiwami_scene* scene, uint32_t geometry_id,
                                   kiwami_geometry* geometry) {
  return guarded(device_of(scene), [&] {
    check_fits(scene, geometry);
    object_of(scene)->replace(geometry_id, *object_of(geometry));
  });
}

kiwami_result kiwami_scene_enable(kiwami_scene* scene, uint32_t geometry_id, int32_t is_enabled) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    object_of(scene)->enable(geometry_id, is_enabled != 0);
  });
}

kiwami_result kiwami_scene_set_parameter(kiwami_scene* scene, uint32_t parameter, double value) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    object_of(scene)->parameters().set(parameter, value);
  });
}

kiwami_result kiwami_parameter_bounds(uint32_t parameter, double* lowest, double* highest,
                                      double* preset) {
  return guarded(nullptr, [&] {
    const ParameterBounds bounds = parameter_bounds(parameter);
    if (lowest) *lowest = bounds.lowest;
    if (highest) *highest = bounds.highest;
    if (preset) *preset = bounds.preset;
  });
}

kiwami_result kiwami_scene_set_optimizers(kiwami_scene* scene, const uint32_t* methods,
                                          size_t count) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    if (count != 0) check_not_null(methods, "methods");
    object_of(scene)->parameters().set_optimizers({methods, count});
  });
}

kiwami_result kiwami_scene_set_representative_rays(kiwami_scene* scene, const kiwami_ray* rays,
                                                   size_t stride, size_t count) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    if (count != 0) check_array("rays", rays, stride, sizeof(kiwami_ray), count);
    const DefaultFloatEnvironment environment;
    object_of(scene)->set_representative_rays(
        copy_representative_rays(rays, stride, count, object_of(scene)->device().memory()));
  });
}

kiwami_result kiwami_quality_methods(uint32_t quality, uint32_t* builder, uint32_t* optimizers,
                                     size_t* optimizer_count, uint32_t* contraction) {
  return guarded(nullptr, [&] {
    const QualityMethods& methods = quality_methods(quality);
    if (builder) *builder = methods.builder;
    if (optimizers) std::copy(methods.optimizers.begin(), methods.optimizers.end(), optimizers);
    if (optimizer_count) *optimizer_count = methods.optimizers.size();
    if (contraction) *contraction = methods.contraction;
  });
}

const char* kiwami_method_name(uint32_t stage, uint32_t method) {
  return method_name(stage, method);
}

kiwami_result kiwami_scene_set_progress(kiwami_scene* scene, kiwami_progress function, void* user) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    object_of(scene)->set_progress(function, user);
  });
}

kiwami_result kiwami_scene_commit(kiwami_scene* scene) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    const DefaultFloatEnvironment environment;
    object_of(scene)->commit();
  });
}

kiwami_result kiwami_scene_refit(kiwami_scene* scene) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    const DefaultFloatEnvironment environment;
    object_of(scene)->refit();
  });
}

kiwami_result kiwami_scene_get_info(const kiwami_scene* scene, kiwami_scene_info* info) {
  return guarded(device_of(scene), [&] {
    check_not_null(scene, "scene");
    check_not_null(info, "info");
    write_info(info, kMinimumInfoSize, "info", committed_of(scene).info());
  });
}

kiwami_result kiwami_scene_validate(const kiwami_scene* scene) {
  return guarded(device_of(scene), [&] {
    const DefaultFloatEnvironment environment;
    committed_of(scene).validate();
  });
}

}  // extern "C"
