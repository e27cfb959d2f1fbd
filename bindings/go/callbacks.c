// SPDX-License-Identifier: Apache-2.0
#include "callbacks.h"

#include "_cgo_export.h"

static int32_t filter(void* user, const kiwami_filter_candidate* candidate) {
  return kiwamiGoFilter((uintptr_t)user, (kiwami_filter_candidate*)candidate);
}

void kiwami_go_query_init(kiwami_query* query, uintptr_t handle) {
  kiwami_query_init(query, sizeof(*query));
  query->filter = filter;
  query->filter_user = (void*)handle;
}

static int32_t progress(void* user, double fraction) {
  return kiwamiGoProgress((uintptr_t)user, fraction);
}

kiwami_result kiwami_go_set_progress(kiwami_scene* scene, uintptr_t handle) {
  return kiwami_scene_set_progress(scene, handle ? progress : NULL, (void*)handle);
}

static int32_t bounds(void* user, uint32_t first, uint32_t count, float* boxes) {
  return kiwamiGoBounds((uintptr_t)user, first, count, boxes);
}

static int32_t intersect(void* user, kiwami_user_intersection* intersection) {
  return kiwamiGoIntersect((uintptr_t)user, intersection);
}

static void destroy(void* user) { kiwamiGoDestroy((uintptr_t)user); }

kiwami_result kiwami_go_user_geometry_create(kiwami_device* device, uint64_t count, uint32_t mask,
                                             uintptr_t handle, kiwami_geometry** geometry) {
  kiwami_user_geometry_desc desc;
  const kiwami_result result = kiwami_user_geometry_desc_init(&desc, sizeof(desc));
  if (result != KIWAMI_OK) return result;
  desc.count = count;
  desc.bounds = bounds;
  desc.intersect = intersect;
  desc.destroy = destroy;
  desc.user = (void*)handle;
  desc.mask = mask;
  return kiwami_user_geometry_create(device, &desc, geometry);
}
