// SPDX-License-Identifier: Apache-2.0
#include "api/api_support.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <thread>

#include "support/random.h"

namespace kiwami_api_tests {

using kiwami_tests::Random;

kiwami_device_desc default_device() {
  kiwami_device_desc desc;
  EXPECT_EQ(kiwami_device_desc_init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

kiwami_triangle_mesh_desc default_mesh() {
  kiwami_triangle_mesh_desc desc;
  EXPECT_EQ(kiwami_triangle_mesh_desc_init(&desc, sizeof desc), KIWAMI_OK);
  return desc;
}

Device make_device(const kiwami_device_desc& desc) {
  kiwami_device* device = nullptr;
  EXPECT_EQ(kiwami_device_create(&desc, &device), KIWAMI_OK) << last_error();
  return Device(device);
}

Device make_device(uint32_t isa) {
  kiwami_device_desc desc = default_device();
  desc.isa = isa;
  return make_device(desc);
}

Geometry make_mesh(const Device& device, const kiwami_triangle_mesh_desc& desc) {
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_triangle_mesh_create(device.get(), &desc, &geometry), KIWAMI_OK) << last_error();
  return Geometry(geometry);
}

Scene make_scene(const Device& device) {
  kiwami_scene* scene = nullptr;
  EXPECT_EQ(kiwami_scene_create(device.get(), &scene), KIWAMI_OK) << last_error();
  return Scene(scene);
}

Scene make_scene(const Device& device, const Geometry& geometry) {
  Scene scene = make_scene(device);
  EXPECT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK) << last_error();
  EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  return scene;
}

Bvh bvh_of(const Scene& scene) {
  kiwami_bvh* bvh = nullptr;
  EXPECT_EQ(kiwami_scene_get_bvh(scene.get(), &bvh), KIWAMI_OK) << last_error();
  return Bvh(bvh);
}

kiwami_scene_info info_of(const Scene& scene) {
  kiwami_scene_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_scene_get_info(scene.get(), &info), KIWAMI_OK) << last_error();
  return info;
}

kiwami_bvh_info info_of(const Bvh& bvh) {
  kiwami_bvh_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_bvh_get_info(bvh.get(), &info), KIWAMI_OK) << last_error();
  return info;
}

std::vector<kiwami_bvh_node> nodes_of(const Bvh& bvh) {
  std::vector<kiwami_bvh_node> nodes(info_of(bvh).node_count);
  EXPECT_EQ(kiwami_bvh_get_nodes(bvh.get(), 0, nodes.size(), nodes.data(), 0), KIWAMI_OK)
      << last_error();
  return nodes;
}

std::vector<kiwami_bvh_primitive> primitives_of(const Bvh& bvh) {
  std::vector<kiwami_bvh_primitive> primitives(info_of(bvh).primitive_count);
  EXPECT_EQ(kiwami_bvh_get_primitives(bvh.get(), 0, primitives.size(), primitives.data(), 0),
            KIWAMI_OK)
      << last_error();
  return primitives;
}

std::string last_error(const kiwami_device* device) {
  std::string text(kiwami_last_error(device, nullptr, 0), '\0');
  kiwami_last_error(device, text.data(), text.size());
  text.pop_back();
  return text;
}

kiwami_triangle_mesh_desc Triangles::desc() const {
  kiwami_triangle_mesh_desc desc = default_mesh();
  desc.vertices = vertices.data();
  desc.vertex_count = vertices.size() / 3;
  desc.indices = indices.data();
  desc.triangle_count = indices.size() / 3;
  return desc;
}

Triangles square(float z) { return {{-1, -1, z, 1, -1, z, 1, 1, z, -1, 1, z}, {0, 1, 2, 0, 2, 3}}; }

Triangles random_triangles(uint32_t count, uint64_t seed) {
  Random random(seed);
  Triangles made;
  for (uint32_t i = 0; i < count; ++i) {
    const float centre[3] = {random.symmetric(), random.symmetric(), random.symmetric()};
    for (uint32_t corner = 0; corner < 3; ++corner) {
      for (float coordinate : centre) {
        made.vertices.push_back(coordinate + 0.1f * random.symmetric());
      }
      made.indices.push_back(3 * i + corner);
    }
  }
  return made;
}

std::vector<kiwami_ray> random_rays(size_t count, uint64_t seed) {
  Random random(seed, 1);
  std::vector<kiwami_ray> rays(count);
  for (kiwami_ray& ray : rays) {
    float origin[3], target[3];
    for (int axis = 0; axis < 3; ++axis) {
      origin[axis] = 2 * random.symmetric();
      target[axis] = random.symmetric();
    }
    ray = ray_along_z(origin[0], origin[1]);
    ray.origin_z = origin[2];
    ray.direction_x = target[0] - origin[0];
    ray.direction_y = target[1] - origin[1];
    ray.direction_z = target[2] - origin[2];
    ray.time = random.unit();
    ray.tmin = random.one_in(4) ? random.unit() : 0.0f;
    ray.tmax = random.one_in(4) ? 2 * random.unit() : kInfinity;
    ray.flags = random.one_in(4) ? random.below(4) : 0;
  }
  return rays;
}

kiwami_ray ray_along_z(float x, float y) {
  return {x, y, 0, 0, 0, 0, 1, kInfinity, 0, ~uint32_t{0}, 0, 0};
}

std::vector<kiwami_hit> closest_hits(const Scene& scene, const std::vector<kiwami_ray>& rays) {
  std::vector<kiwami_hit> hits(rays.size());
  EXPECT_EQ(kiwami_closest_hit(scene.get(), rays.data(), 0, hits.data(), 0, rays.size(), nullptr),
            KIWAMI_OK)
      << last_error();
  return hits;
}

kiwami_hit closest_hit(const Scene& scene, const kiwami_ray& ray) {
  return closest_hits(scene, {ray})[0];
}

bool are_equal(const std::vector<kiwami_hit>& a, const std::vector<kiwami_hit>& b) {
  // An empty vector may have no address, which memcmp may not be told.
  return a.size() == b.size() &&
         (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof a[0]) == 0);
}

namespace {

/// What a block remembers of its allocation, just before its first byte.
struct BlockHeader {
  void* start;
  size_t size, alignment;
};

}  // namespace

void CountingAllocator::install(kiwami_device_desc& desc) {
  desc.allocate = &CountingAllocator::allocate;
  desc.deallocate = &CountingAllocator::deallocate;
  desc.allocator_user = this;
}

void* CountingAllocator::allocate(void* user, size_t size, size_t alignment) {
  CountingAllocator& self = *static_cast<CountingAllocator*>(user);
  if (self.calls.fetch_add(1) >= self.first_failure) return nullptr;
  void* start = std::malloc(sizeof(BlockHeader) + alignment + self.misplacement + size);
  if (!start) return nullptr;
  const uintptr_t free = reinterpret_cast<uintptr_t>(start) + sizeof(BlockHeader);
  const uintptr_t block = (free + alignment - 1) / alignment * alignment + self.misplacement;
  const BlockHeader header{start, size, alignment};
  std::memcpy(reinterpret_cast<void*>(block - sizeof header), &header, sizeof header);
  const size_t live = self.live_bytes += size;
  size_t peak = self.peak_bytes;
  while (peak < live && !self.peak_bytes.compare_exchange_weak(peak, live)) {
  }
  ++self.live_blocks;
  return reinterpret_cast<void*>(block);
}

void CountingAllocator::deallocate(void* user, void* memory, size_t size, size_t alignment) {
  CountingAllocator& self = *static_cast<CountingAllocator*>(user);
  BlockHeader header;
  std::memcpy(&header, static_cast<char*>(memory) - sizeof header, sizeof header);
  if (header.size != size || header.alignment != alignment) ++self.mismatches;
  self.live_bytes -= size;
  --self.live_blocks;
  std::free(header.start);
}

void ThreadRunner::install(kiwami_device_desc& desc, uint32_t width) {
  desc.runner = &ThreadRunner::run;
  desc.runner_user = this;
  desc.runner_width = width;
}

int32_t ThreadRunner::run(void* user, size_t count, kiwami_parallel_task task, void* data) {
  ThreadRunner& self = *static_cast<ThreadRunner*>(user);
  ++self.loops;
  const size_t tasks = count - (self.skipped_calls < count ? self.skipped_calls : count);
  std::atomic<size_t> left{tasks};
  const auto work = [&] {
    for (;;) {
      size_t index = left.load();
      while (index != 0 && !left.compare_exchange_weak(index, index - 1)) {
      }
      if (index == 0) return;
      task(data, index - 1);
    }
  };
  std::vector<std::thread> pool;
  for (unsigned i = 1; i < self.threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
  return self.status;
}

}  // namespace kiwami_api_tests
