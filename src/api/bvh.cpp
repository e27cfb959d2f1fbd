// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bvh.h"

#include "api/check.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumInfoSize = 8;

/// Copies elements of a tree out to a strided array.
template <typename T>
void copy_out(const Array<T>& elements, const char* name, size_t first, size_t count, T* target,
              size_t stride) {
  if (first > elements.size() || count > elements.size() - first) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "first is %zu and count is %zu, expected some of the %zu %s of the tree", first,
                count, elements.size(), name);
  }
  if (count == 0) return;
  check_array(name, target, stride, sizeof(T), count);
  const size_t step = stride ? stride : sizeof(T);
  auto* bytes = reinterpret_cast<unsigned char*>(target);
  for (size_t i = 0; i < count; ++i) {
    std::memcpy(bytes + i * step, &elements[first + i], sizeof(T));
  }
}

}  // namespace

extern "C" {

kiwami_result kiwami_scene_get_bvh(const kiwami_scene* scene, kiwami_bvh** bvh) {
  if (bvh) *bvh = nullptr;
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    check_not_null(bvh, "bvh");
    const DefaultFloatEnvironment environment;
    *bvh = reinterpret_cast<kiwami_bvh*>(Bvh::create(object_of(scene)->device(), committed));
  });
}

void kiwami_bvh_retain(kiwami_bvh* bvh) {
  if (bvh) object_of(bvh)->retain();
}

void kiwami_bvh_release(kiwami_bvh* bvh) {
  if (bvh) object_of(bvh)->release();
}

kiwami_result kiwami_bvh_get_info(const kiwami_bvh* bvh, kiwami_bvh_info* info) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    write_info(info, kMinimumInfoSize, "info", object_of(bvh)->info());
  });
}

kiwami_result kiwami_bvh_get_nodes(const kiwami_bvh* bvh, size_t first, size_t count,
                                   kiwami_bvh_node* nodes, size_t stride) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    copy_out(object_of(bvh)->nodes(), "nodes", first, count, nodes, stride);
  });
}

kiwami_result kiwami_bvh_get_primitives(const kiwami_bvh* bvh, size_t first, size_t count,
                                        kiwami_bvh_primitive* primitives, size_t stride) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    copy_out(object_of(bvh)->primitives(), "primitives", first, count, primitives, stride);
  });
}

}  // extern "C"
