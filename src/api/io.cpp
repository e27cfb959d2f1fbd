// SPDX-License-Identifier: Apache-2.0
#include "kiwami/io.h"

#include "api/check.h"
#include "io/bvh_file.h"
#include "io/light_file.h"
#include "io/scene_file.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;
constexpr size_t kMinimumInfoSize = 8;

// Every default is zero.
constexpr kiwami_save_desc kDefaultSaveDesc{};
constexpr kiwami_load_desc kDefaultLoadDesc{};

int count_of(bool a, bool b, bool c) { return (a ? 1 : 0) + (b ? 1 : 0) + (c ? 1 : 0); }

kiwami_save_desc read_save_desc(const kiwami_save_desc* given) {
  const kiwami_save_desc desc = read_descriptor(given, kMinimumDescSize, "desc", kDefaultSaveDesc);
  check_reserved("desc.flags", desc.flags);
  if (count_of(desc.path, desc.write, desc.data) > 1) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc has several of path, write and data, expected at most one");
  }
  if (!desc.data && desc.capacity != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.data is NULL with desc.capacity %llu, expected memory",
                static_cast<unsigned long long>(desc.capacity));
  }
  return desc;
}

/// Says how large a file is, and throws where it did not fit.
void deliver_size(uint64_t size, const kiwami_save_desc& desc, uint64_t* bytes) {
  if (bytes) *bytes = size;
  if (desc.data && desc.capacity < size) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.capacity is %llu, expected at least %llu",
                static_cast<unsigned long long>(desc.capacity),
                static_cast<unsigned long long>(size));
  }
}

kiwami_load_desc read_load_desc(const kiwami_load_desc* given) {
  const kiwami_load_desc desc = read_descriptor(given, kMinimumDescSize, "desc", kDefaultLoadDesc);
  constexpr uint32_t kFlags = KIWAMI_LOAD_MAP | KIWAMI_LOAD_TRUSTED;
  if (desc.flags & ~kFlags) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected KIWAMI_LOAD_* bits",
                desc.flags);
  }
  check_reserved("desc.reserved", desc.reserved);
  if (count_of(desc.path, desc.read, desc.data) != 1) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc has %d of path, read and data, expected one of them",
                count_of(desc.path, desc.read, desc.data));
  }
  if (desc.data) {
    if (desc.size != 0) check_array("desc.data", desc.data, 0, 1, static_cast<size_t>(desc.size));
  } else if (desc.size != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.size is %llu without desc.data, expected 0",
                static_cast<unsigned long long>(desc.size));
  }
  const uint32_t width = desc.bvh_width;
  if (width != 0 && width != 4 && width != 8 && width != 16) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.bvh_width is %u, expected 0, 4, 8 or 16",
                width);
  }
  return desc;
}

void check_no_width(const kiwami_load_desc& desc, const char* what) {
  if (desc.bvh_width == 0) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.bvh_width is %u, expected 0 for %s",
              desc.bvh_width, what);
}

}  // namespace

extern "C" {

kiwami_result kiwami_save_desc_init(kiwami_save_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", kDefaultSaveDesc); });
}

kiwami_result kiwami_load_desc_init(kiwami_load_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", kDefaultLoadDesc); });
}

kiwami_result kiwami_scene_save(const kiwami_scene* scene, const kiwami_save_desc* desc,
                                uint64_t* bytes) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    const kiwami_save_desc checked = read_save_desc(desc);
    deliver_size(save_scene(*object_of(scene), committed, checked), checked, bytes);
  });
}

kiwami_result kiwami_scene_load(kiwami_device* device, const kiwami_load_desc* desc,
                                kiwami_scene** scene) {
  if (scene) *scene = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(scene, "scene");
    const DefaultFloatEnvironment environment;
    *scene = reinterpret_cast<kiwami_scene*>(load_scene(*object_of(device), read_load_desc(desc)));
  });
}

kiwami_result kiwami_bvh_save(const kiwami_bvh* bvh, const kiwami_save_desc* desc,
                              uint64_t* bytes) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const kiwami_save_desc checked = read_save_desc(desc);
    deliver_size(save_bvh(*object_of(bvh), checked), checked, bytes);
  });
}

kiwami_result kiwami_bvh_load(kiwami_device* device, const kiwami_load_desc* desc,
                              kiwami_bvh** bvh) {
  if (bvh) *bvh = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(bvh, "bvh");
    const kiwami_load_desc checked = read_load_desc(desc);
    check_no_width(checked, "a tree");
    const DefaultFloatEnvironment environment;
    *bvh = reinterpret_cast<kiwami_bvh*>(load_bvh(*object_of(device), checked));
  });
}

kiwami_result kiwami_light_tree_save(const kiwami_light_tree* tree, const kiwami_save_desc* desc,
                                     uint64_t* bytes) {
  const auto* const object = reinterpret_cast<const LightTree*>(tree);
  return guarded(object ? &object->device() : nullptr, [&] {
    check_not_null(tree, "tree");
    if (!object->committed()) {
      throw Error(
          KIWAMI_ERROR_INVALID_STATE,
          "tree was never committed, expected a successful kiwami_light_tree_commit before");
    }
    const kiwami_save_desc checked = read_save_desc(desc);
    deliver_size(save_lights(*object, *object->committed(), checked), checked, bytes);
  });
}

kiwami_result kiwami_light_tree_load(kiwami_device* device, const kiwami_load_desc* desc,
                                     kiwami_light_tree** tree) {
  if (tree) *tree = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(tree, "tree");
    const kiwami_load_desc checked = read_load_desc(desc);
    check_no_width(checked, "a set of lights");
    const DefaultFloatEnvironment environment;
    *tree = reinterpret_cast<kiwami_light_tree*>(load_lights(*object_of(device), checked));
  });
}

kiwami_result kiwami_file_get_info(kiwami_device* device, const kiwami_load_desc* desc,
                                   kiwami_file_info* info) {
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    const kiwami_load_desc checked = read_load_desc(desc);
    if (checked.read) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "desc.read is set, expected desc.path or desc.data: a stream is read once");
    }
    write_info(info, kMinimumInfoSize, "info", describe_file(*object_of(device), checked));
  });
}

}  // extern "C"
