// SPDX-License-Identifier: Apache-2.0
// Counts what a ray costs with each instruction set and node width: instructions, and visits of
// nodes and leaf blocks. For emulated CPUs, whose time stamp counter goes up by one an instruction.
//
//   emulator_counts [--rays N]
//
//   --rays N   rays of each kind (default 2000)
//
// Fails where the counter does not count instructions, as on a real CPU.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#if defined(__x86_64__)
#include <x86intrin.h>
#endif

#include "kiwami/kiwami.h"
#include "scene/procedural.h"
#include "scene/random.h"
#include "support/library.h"

namespace {

using namespace kiwami_tests;
using kiwami::tools::Random;

constexpr uint32_t kWidths[] = {4, 8, 16};

[[noreturn]] void fail(const std::string& sentence) { throw std::runtime_error(sentence); }

uint64_t read_counter() {
#if defined(__x86_64__)
  return __rdtsc();
#else
  return 0;
#endif
}

/// Runs a loop of two instructions a turn. The counter must tell so, but for what the kernel adds.
void check_counter() {
#if defined(__x86_64__)
  constexpr uint64_t kTurns = 10000000;
  uint64_t turns = kTurns;
  const uint64_t start = read_counter();
  __asm__ volatile("1: dec %0\n\tjnz 1b" : "+r"(turns) : : "cc");
  const uint64_t spent = read_counter() - start;
  if (spent > 2 * kTurns * 98 / 100 && spent < 2 * kTurns * 105 / 100) return;
  fail("the time stamp counter went up by " + std::to_string(spent) + " in " +
       std::to_string(2 * kTurns) + " instructions: run this on an emulated CPU");
#else
  fail("there is no time stamp counter");
#endif
}

/// A fixed scene: a rough terrain, and triangles of all sizes above it.
std::vector<kiwami::tools::Mesh> make_meshes() {
  return {kiwami::tools::make_terrain(70), kiwami::tools::make_soup(6000, 1)};
}

SceneHandle build(kiwami_device* device, const std::vector<kiwami::tools::Mesh>& meshes,
                  uint32_t width) {
  kiwami_scene* scene = nullptr;
  check(kiwami_scene_create(device, &scene));
  SceneHandle owner(scene);
  check(kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_BVH_WIDTH, width));
  for (const kiwami::tools::Mesh& mesh : meshes) {
    kiwami_triangle_mesh_desc desc;
    check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = mesh.vertices.data();
    desc.vertex_count = mesh.vertex_count();
    desc.indices = mesh.indices.data();
    desc.triangle_count = mesh.triangle_count();
    kiwami_geometry* geometry = nullptr;
    check(kiwami_triangle_mesh_create(device, &desc, &geometry));
    const std::unique_ptr<kiwami_geometry, Release> holder(geometry);
    check(kiwami_scene_attach(scene, geometry, nullptr));
  }
  check(kiwami_scene_commit(scene));
  return owner;
}

/// From anywhere in the scene to anywhere.
std::vector<kiwami_ray> make_rays(size_t count) {
  Random random(1);
  std::vector<kiwami_ray> rays(count);
  for (kiwami_ray& ray : rays) {
    ray = kiwami_ray{};
    ray.origin_x = random.uniform(-1.0f, 1.0f);
    ray.origin_y = random.uniform(-0.5f, 1.0f);
    ray.origin_z = random.uniform(-1.0f, 1.0f);
    ray.direction_x = random.uniform(-1.0f, 1.0f);
    ray.direction_y = random.uniform(-1.0f, 1.0f);
    ray.direction_z = random.uniform(-1.0f, 1.0f);
    ray.tmax = std::numeric_limits<float>::infinity();
    ray.mask = ~0u;
  }
  return rays;
}

/// Instructions of one call a ray, the interface's included.
double instructions(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays, bool any_hit) {
  kiwami_query query;
  check(kiwami_query_init(&query, sizeof query));
  query.flags = KIWAMI_QUERY_CALLING_THREAD;
  kiwami_hit hit;
  uint8_t occluded = 0;
  const uint64_t start = read_counter();
  for (const kiwami_ray& ray : rays) {
    const kiwami_result result = any_hit ? kiwami_any_hit(scene, &ray, 0, &occluded, 0, 1, &query)
                                         : kiwami_closest_hit(scene, &ray, 0, &hit, 0, 1, &query);
    check(result);
  }
  return static_cast<double>(read_counter() - start) / static_cast<double>(rays.size());
}

void print_row(const char* isa, uint32_t width, const kiwami_scene* scene,
               const std::vector<kiwami_ray>& rays, bool any_hit) {
  kiwami_visits visits{};
  visits.struct_size = sizeof visits;
  check(kiwami_scene_count_visits(scene, rays.data(), 0, rays.size(),
                                  any_hit ? KIWAMI_COUNT_ANY_HIT : KIWAMI_COUNT_CLOSEST_HIT,
                                  &visits, nullptr, 0));
  const auto count = static_cast<double>(rays.size());
  std::printf("%-7s %5u  %-11s %12.1f %6.2f %6.2f\n", isa, width,
              any_hit ? "any hit" : "closest hit", instructions(scene, rays, any_hit),
              static_cast<double>(visits.node_visits) / count,
              static_cast<double>(visits.leaf_visits) / count);
}

void run(size_t ray_count) {
  check_counter();
  const std::vector<kiwami::tools::Mesh> meshes = make_meshes();
  const std::vector<kiwami_ray> rays = make_rays(ray_count);
  const std::vector<uint32_t> available = available_isas();
  std::printf("%-7s %5s  %-11s %12s %6s %6s\n", "isa", "width", "query", "instructions", "nodes",
              "leaves");
  for (const uint32_t isa : available) {
    const DeviceHandle device = make_device(isa, 1);
    for (const uint32_t width : kWidths) {
      if ((info_of(device.get()).native_widths & 1u << width) == 0) continue;
      const SceneHandle scene = build(device.get(), meshes, width);
      for (const bool any_hit : {false, true}) {
        print_row(kiwami_isa_name(isa), width, scene.get(), rays, any_hit);
      }
    }
  }
}

size_t parse(int argc, char** argv) {
  if (argc == 1) return 2000;
  if (argc != 3 || std::string(argv[1]) != "--rays") fail("expected nothing or --rays N");
  const size_t count = std::strtoull(argv[2], nullptr, 10);
  if (count == 0) fail("--rays must be a number above 0");
  return count;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "emulator_counts: %s\n", error.what());
    return 1;
  }
}
