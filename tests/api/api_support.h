// SPDX-License-Identifier: Apache-2.0
// The C interface behind owning handles, and the callbacks that the tests give to it.
#pragma once

#include <kiwami/kiwami.h>

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace kiwami_api_tests {

struct Release {
  void operator()(kiwami_device* device) const { kiwami_device_release(device); }
  void operator()(kiwami_geometry* geometry) const { kiwami_geometry_release(geometry); }
  void operator()(kiwami_scene* scene) const { kiwami_scene_release(scene); }
  void operator()(kiwami_bvh* bvh) const { kiwami_bvh_release(bvh); }
};
using Device = std::unique_ptr<kiwami_device, Release>;
using Geometry = std::unique_ptr<kiwami_geometry, Release>;
using Scene = std::unique_ptr<kiwami_scene, Release>;
using Bvh = std::unique_ptr<kiwami_bvh, Release>;

constexpr float kInfinity = std::numeric_limits<float>::infinity();

kiwami_device_desc default_device();
kiwami_triangle_mesh_desc default_mesh();

/// These fail the running test where the call fails.
Device make_device(const kiwami_device_desc& desc);
Device make_device(uint32_t isa = KIWAMI_ISA_AUTO);
Geometry make_mesh(const Device& device, const kiwami_triangle_mesh_desc& desc);
Scene make_scene(const Device& device);
/// A committed scene of one geometry.
Scene make_scene(const Device& device, const Geometry& geometry);
kiwami_scene_info info_of(const Scene& scene);
/// The tree of a committed scene, and what is in it.
Bvh bvh_of(const Scene& scene);
kiwami_bvh_info info_of(const Bvh& bvh);
std::vector<kiwami_bvh_node> nodes_of(const Bvh& bvh);
std::vector<kiwami_bvh_primitive> primitives_of(const Bvh& bvh);

/// The whole sentence of the last error.
std::string last_error(const kiwami_device* device = nullptr);

/// Vertices and indices, tightly packed.
struct Triangles {
  std::vector<float> vertices;
  std::vector<uint32_t> indices;

  kiwami_triangle_mesh_desc desc() const;
};

/// The square -1 <= x, y <= 1 at a z, its normals along +z.
Triangles square(float z);
/// Random small triangles in the cube from -1 to 1.
Triangles random_triangles(uint32_t count, uint64_t seed);
/// Rays from around that cube into it, some of which miss.
std::vector<kiwami_ray> random_rays(size_t count, uint64_t seed);

/// A ray along +z through (x, y, 0).
kiwami_ray ray_along_z(float x, float y);

std::vector<kiwami_hit> closest_hits(const Scene& scene, const std::vector<kiwami_ray>& rays);
kiwami_hit closest_hit(const Scene& scene, const kiwami_ray& ray);
/// Whether two runs of answers are equal to the bit.
bool are_equal(const std::vector<kiwami_hit>& a, const std::vector<kiwami_hit>& b);

/// Counts what the library holds; can be told to fail.
class CountingAllocator {
 public:
  /// Directs desc to this allocator, which must outlive the device.
  void install(kiwami_device_desc& desc);

  std::atomic<size_t> live_bytes{0};
  std::atomic<size_t> peak_bytes{0};  ///< the highest live_bytes
  std::atomic<size_t> live_blocks{0};
  std::atomic<size_t> calls{0};
  std::atomic<size_t> mismatches{0};  ///< deallocations with another size or alignment
  /// The number of the allocation that fails, and all after it; the first is 0.
  size_t first_failure = std::numeric_limits<size_t>::max();
  size_t misplacement = 0;  ///< bytes by which every block misses its alignment

 private:
  static void* allocate(void* user, size_t size, size_t alignment);
  static void deallocate(void* user, void* memory, size_t size, size_t alignment);
};

/// Runs tasks on plain threads, the highest index first on each.
struct ThreadRunner {
  void install(kiwami_device_desc& desc, uint32_t width);

  unsigned threads = 2;
  int32_t status = 0;            ///< what the runner returns
  size_t skipped_calls = 0;      ///< tasks that it leaves out
  std::atomic<size_t> loops{0};  ///< how often it was called

 private:
  static int32_t run(void* user, size_t count, kiwami_parallel_task task, void* data);
};

}  // namespace kiwami_api_tests
