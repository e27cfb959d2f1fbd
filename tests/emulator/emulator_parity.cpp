// SPDX-License-Identifier: Apache-2.0
// Checks, through the public interface alone, that this CPU gets the kernels it should, that those
// it cannot run are refused, and that all that it can run agree with the scalar ones to the bit.
//
//   emulator_parity [--isa NAME] [--rays N] [--seed N]
//
//   --isa NAME   the instruction set that the library must choose here (scalar, sse, avx2, avx512);
//                without it, any
//   --rays N     rays, spread over the scenes; each is traced by every ISA and width (default 2000)
//   --seed N     of scenes and rays (default 1)
//
// The last line is a digest of all answers: it must be the same on every machine.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>
#include <vector>

#include "kiwami/kiwami.h"
#include "support/adversarial_scenes.h"
#include "support/closed_meshes.h"
#include "support/library.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace {

using namespace kiwami_tests;

constexpr uint32_t kIsas[] = {KIWAMI_ISA_SCALAR, KIWAMI_ISA_SSE, KIWAMI_ISA_AVX2,
                              KIWAMI_ISA_AVX512};
constexpr uint32_t kWidths[] = {4, 8, 16};

[[noreturn]] void fail(const std::string& sentence) { throw std::runtime_error(sentence); }

struct Options {
  std::string isa;
  size_t rays = 2000;
  uint64_t seed = 1;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) fail(name + " needs a value");
    const char* value = argv[i + 1];
    if (name == "--isa") {
      options.isa = value;
    } else if (name == "--rays") {
      options.rays = std::strtoull(value, nullptr, 10);
    } else if (name == "--seed") {
      options.seed = std::strtoull(value, nullptr, 10);
    } else {
      fail("unknown option " + name);
    }
  }
  if (options.rays == 0) fail("--rays must be a number above 0");
  return options;
}

/// The ISA that the library chooses by itself, which must be the expected one, if one is.
uint32_t check_choice(const std::string& expected) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  const uint32_t chosen = info_of(device.get()).isa;
  const std::string name = kiwami_isa_name(chosen);
  if (!expected.empty() && expected != name) fail("chose " + name + ", expected " + expected);
  std::printf("chose %s\n", name.c_str());
  return chosen;
}

/// Asking for an ISA that this CPU lacks must be answered with the error that says so.
void check_refusal(uint32_t isa) {
  kiwami_device_desc desc;
  check(kiwami_device_desc_init(&desc, sizeof desc));
  desc.isa = isa;
  kiwami_device* device = nullptr;
  const kiwami_result result = kiwami_device_create(&desc, &device);
  const DeviceHandle owner(device);
  if (result != KIWAMI_ERROR_UNSUPPORTED_ISA || device != nullptr)
    fail(std::string(kiwami_isa_name(isa)) +
         " was to be refused, the result is: " + kiwami_result_name(result));
  std::printf("refused %s\n", kiwami_isa_name(isa));
}

/// Devices of every ISA up to the chosen one; those beyond it must be refused.
std::vector<DeviceHandle> devices_up_to(uint32_t chosen) {
  std::vector<DeviceHandle> devices;
  for (const uint32_t isa : kIsas) {
    if (isa > chosen) {
      check_refusal(isa);
      continue;
    }
    devices.push_back(make_device(isa, 1));
    if (info_of(devices.back().get()).isa != isa)
      fail(std::string(kiwami_isa_name(isa)) + " made a device of another ISA");
  }
  return devices;
}

/// Sixty small scenes, each kind of adversarial one three times, and closed meshes. All are made
/// with exact operations, since the library of elementary functions differs between machines.
std::vector<Scene> make_scenes(uint64_t seed) {
  std::vector<Scene> scenes;
  for (uint32_t i = 0; i < 60; ++i) scenes.push_back(adversarial_scene(i, seed));
  for (const ClosedMesh& closed : closed_meshes()) {
    if (closed.name != "torus") scenes.push_back(scene_of(closed));
  }
  return scenes;
}

std::vector<kiwami_ray> make_rays(const Scene& scene, size_t count, uint64_t seed) {
  RayGenerator generator(scene, Random(seed));
  std::vector<kiwami_ray> rays(count);
  for (kiwami_ray& ray : rays) ray = generator.next();
  return rays;
}

/// Closest hits; fails where any hit disagrees with them.
std::vector<kiwami_hit> trace(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays,
                              const std::string& where) {
  const std::vector<kiwami_hit> hits = closest_hits(scene, rays);
  const std::vector<uint8_t> occluded = any_hits(scene, rays);
  for (size_t i = 0; i < rays.size(); ++i) {
    if (occluded[i] != (hits[i].primitive_id != KIWAMI_INVALID_ID))
      fail(where + ": any hit disagrees with the closest hit\n  " + describe(rays[i]));
  }
  return hits;
}

struct Totals {
  uint64_t traced = 0, hits = 0, digest = 0xCBF29CE484222325ull;

  /// FNV-1a over the bytes of the answers.
  void add(const std::vector<kiwami_hit>& answers) {
    for (const kiwami_hit& hit : answers) hits += hit.primitive_id != KIWAMI_INVALID_ID;
    const unsigned char* bytes = reinterpret_cast<const unsigned char*>(answers.data());
    for (size_t i = 0; i < answers.size() * sizeof(kiwami_hit); ++i)
      digest = (digest ^ bytes[i]) * 0x100000001B3ull;
  }
};

/// Every device and native width against the scalar kernels of width 4 without merging.
void check_scene(const std::vector<DeviceHandle>& devices, const Scene& source,
                 const std::vector<kiwami_ray>& rays, Totals& totals) {
  const SceneHandle plain =
      make_scene(devices[0].get(), source, {.width = 4, .merges_leaves = false});
  const std::vector<kiwami_hit> reference = trace(plain.get(), rays, source.name);
  totals.add(reference);
  for (const DeviceHandle& device : devices) {
    const kiwami_device_info info = info_of(device.get());
    for (const uint32_t width : kWidths) {
      if (!(info.native_widths & 1u << width)) continue;
      const std::string where =
          source.name + ", " + kiwami_isa_name(info.isa) + " " + std::to_string(width);
      const SceneHandle scene = make_scene(device.get(), source, {.width = width});
      const std::vector<kiwami_hit> hits = trace(scene.get(), rays, where);
      for (size_t i = 0; i < hits.size(); ++i) {
        if (!is_same(hits[i], reference[i]))
          fail(where + ": " + describe(rays[i]) + "\n  " + describe(hits[i]) + "\n  scalar " +
               describe(reference[i]));
      }
      totals.traced += rays.size();
    }
  }
}

void run(const Options& options) {
  const std::vector<DeviceHandle> devices = devices_up_to(check_choice(options.isa));
  const std::vector<Scene> scenes = make_scenes(options.seed);
  const size_t ray_count = (options.rays + scenes.size() - 1) / scenes.size();
  Totals totals;
  for (size_t i = 0; i < scenes.size(); ++i)
    check_scene(devices, scenes[i], make_rays(scenes[i], ray_count, options.seed + i), totals);
  std::printf("%zu scenes, %" PRIu64 " rays traced, 0 differences; %" PRIu64 " hits\n",
              scenes.size(), totals.traced, totals.hits);
  std::printf("digest %016" PRIx64 "\n", totals.digest);
}

}  // namespace

int main(int argc, char** argv) {
  try {
    run(parse(argc, argv));
    return 0;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "emulator_parity: %s\n", error.what());
    return 1;
  }
}
