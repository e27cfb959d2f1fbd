// SPDX-License-Identifier: Apache-2.0
// The library's handles, released in time, and a device that watches over its memory.
#pragma once

#include <kiwami/kiwami.h>

#include <cstdlib>
#include <memory>

#include "fuzz/fuzz.h"

namespace kiwami_fuzz {

struct Release {
  void operator()(kiwami_device* device) const { kiwami_device_release(device); }
  void operator()(kiwami_geometry* geometry) const { kiwami_geometry_release(geometry); }
  void operator()(kiwami_scene* scene) const { kiwami_scene_release(scene); }
  void operator()(kiwami_bvh* bvh) const { kiwami_bvh_release(bvh); }
  void operator()(kiwami_light_tree* tree) const { kiwami_light_tree_release(tree); }
};
template <typename T>
using Handle = std::unique_ptr<T, Release>;
using Device = Handle<kiwami_device>;
using Geometry = Handle<kiwami_geometry>;
using Scene = Handle<kiwami_scene>;
using Bvh = Handle<kiwami_bvh>;
using Lights = Handle<kiwami_light_tree>;

/// Memory that counts, and refuses beyond a limit.
struct CountedMemory {
  size_t live = 0;
  size_t peak = 0;
  size_t limit = size_t{256} << 20;

  static void* allocate(void* user, size_t size, size_t alignment) {
    CountedMemory& self = *static_cast<CountedMemory*>(user);
    if (size > self.limit || self.live > self.limit - size) return nullptr;
    void* const memory =
        std::aligned_alloc(alignment, (size + alignment - 1) / alignment * alignment);
    if (!memory) return nullptr;
    self.live += size;
    if (self.peak < self.live) self.peak = self.live;
    return memory;
  }
  static void deallocate(void* user, void* memory, size_t size, size_t) {
    static_cast<CountedMemory*>(user)->live -= size;
    std::free(memory);
  }
};

/// A device on the calling thread, so that its memory needs no lock. memory must outlive it.
inline Device make_device(uint32_t isa, uint32_t flags, CountedMemory* memory) {
  kiwami_device_desc desc;
  kiwami_device_desc_init(&desc, sizeof desc);
  desc.isa = isa;
  desc.flags = flags;
  desc.thread_count = 1;
  if (memory) {
    desc.allocate = &CountedMemory::allocate;
    desc.deallocate = &CountedMemory::deallocate;
    desc.allocator_user = memory;
  }
  kiwami_device* device = nullptr;
  require(kiwami_device_create(&desc, &device) == KIWAMI_OK, "no device");
  return Device(device);
}

}  // namespace kiwami_fuzz
