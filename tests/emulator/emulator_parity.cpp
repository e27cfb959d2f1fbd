// SPDX-License-Identifier: Apache-2.0
// Checks, through the public interface alone, that this CPU gets the kernels it should, that those
// it cannot run are refused, and that all that it can run agree with the scalar ones to the bit.
//
//   emulator_parity --isa NAME [--rays N] [--seed N]
//
//   --isa NAME   the instruction set that the library must choose here (scalar, sse, avx2, avx512);
//                "any" accepts what it chooses
//   --rays N     rays, spread over the meshes; each is traced by every ISA and width
//   --seed N     of meshes and rays
//
// The last line is a digest of all answers: it must be the same on every machine.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "generated.h"

namespace {

constexpr uint32_t kIsas[] = {KIWAMI_ISA_SCALAR, KIWAMI_ISA_SSE, KIWAMI_ISA_AVX2,
                              KIWAMI_ISA_AVX512};
constexpr uint32_t kWidths[] = {4, 8, 16};

[[noreturn]] void fail(const std::string& sentence) {
  std::fprintf(stderr, "emulator_parity: %s\n", sentence.c_str());
  std::exit(1);
}

void check(kiwami_result result, const char* call) {
  if (result == KIWAMI_OK) return;
  char text[512];
  kiwami_last_error(nullptr, text, sizeof text);
  fail(std::string(call) + ": " + kiwami_result_name(result) + ": " + text);
}

struct Options {
  std::string isa = "any";
  size_t rays = 2000;
  uint64_t seed = 1;
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; i += 2) {
    const std::string name = argv[i];
    if (i + 1 == argc) fail(name + " needs a value");
    const char* value = argv[i + 1];
    if (name == "--isa")
      options.isa = value;
    else if (name == "--rays")
      options.rays = std::strtoull(value, nullptr, 10);
    else if (name == "--seed")
      options.seed = std::strtoull(value, nullptr, 10);
    else
      fail("unknown option " + name);
  }
  if (options.rays == 0) fail("--rays must be a number above 0");
  return options;
}

/// A device of one ISA; nullptr where it is refused as unsupported.
kiwami_device* device_of(uint32_t isa) {
  kiwami_device_desc desc;
  check(kiwami_device_desc_init(&desc, sizeof desc), "kiwami_device_desc_init");
  desc.isa = isa;
  kiwami_device* device = nullptr;
  const kiwami_result result = kiwami_device_create(&desc, &device);
  if (result == KIWAMI_ERROR_UNSUPPORTED_ISA && device == nullptr) return nullptr;
  check(result, "kiwami_device_create");
  return device;
}

kiwami_device_info info_of(const kiwami_device* device) {
  kiwami_device_info info;
  std::memset(&info, 0, sizeof info);
  info.struct_size = sizeof info;
  check(kiwami_device_get_info(device, &info), "kiwami_device_get_info");
  return info;
}

/// The ISA that the library chooses by itself, which must be the expected one.
uint32_t check_choice(const std::string& expected) {
  kiwami_device* device = device_of(KIWAMI_ISA_AUTO);
  if (!device) fail("no device with the automatic choice");
  const uint32_t chosen = info_of(device).isa;
  kiwami_device_release(device);
  if (expected != "any" && expected != kiwami_isa_name(chosen))
    fail("chose " + std::string(kiwami_isa_name(chosen)) + ", expected " + expected);
  std::printf("chose %s\n", kiwami_isa_name(chosen));
  return chosen;
}

/// Devices of every ISA up to the chosen one; those beyond it must be refused.
std::vector<kiwami_device*> devices_up_to(uint32_t chosen) {
  std::vector<kiwami_device*> devices;
  for (const uint32_t isa : kIsas) {
    kiwami_device* device = device_of(isa);
    const char* name = kiwami_isa_name(isa);
    if (isa > chosen) {
      if (device) fail(std::string(name) + " was to be refused as unsupported");
      std::printf("refused %s\n", name);
      continue;
    }
    if (!device) fail(std::string(name) + " was refused");
    if (info_of(device).isa != isa) fail(std::string(name) + " made a device of another ISA");
    devices.push_back(device);
  }
  return devices;
}

kiwami_scene* scene_of(kiwami_device* device, const generated::Mesh& mesh, uint32_t width,
                       bool merge) {
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc), "kiwami_triangle_mesh_desc_init");
  desc.vertices = mesh.vertices.data();
  desc.vertex_count = mesh.vertices.size();
  desc.indices = mesh.indices.data();
  desc.triangle_count = mesh.triangle_count();
  kiwami_geometry* geometry = nullptr;
  check(kiwami_triangle_mesh_create(device, &desc, &geometry), "kiwami_triangle_mesh_create");
  kiwami_scene* scene = nullptr;
  check(kiwami_scene_create(device, &scene), "kiwami_scene_create");
  check(kiwami_scene_attach(scene, geometry, nullptr), "kiwami_scene_attach");
  kiwami_geometry_release(geometry);
  check(kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_BVH_WIDTH, width), "BVH_WIDTH");
  check(kiwami_scene_set_parameter(scene, KIWAMI_PARAMETER_MERGE_LEAVES, merge), "MERGE_LEAVES");
  check(kiwami_scene_commit(scene), "kiwami_scene_commit");
  return scene;
}

/// Closest hits; fails where any hit disagrees with them.
std::vector<kiwami_hit> trace(kiwami_scene* scene, const std::vector<kiwami_ray>& rays,
                              const std::string& where) {
  std::vector<kiwami_hit> hits(rays.size());
  std::vector<uint8_t> occluded(rays.size());
  check(kiwami_closest_hit(scene, rays.data(), 0, hits.data(), 0, rays.size(), nullptr),
        "kiwami_closest_hit");
  check(kiwami_any_hit(scene, rays.data(), 0, occluded.data(), 0, rays.size(), nullptr),
        "kiwami_any_hit");
  for (size_t i = 0; i < rays.size(); ++i) {
    if (occluded[i] != (hits[i].primitive_id != KIWAMI_INVALID_ID))
      fail(where + ": any hit of ray " + std::to_string(i) + " disagrees with the closest hit");
  }
  return hits;
}

std::string text_of(const kiwami_hit& hit) {
  char text[256];
  std::snprintf(text, sizeof text, "t %a u %a v %a normal %a %a %a primitive %u geometry %u",
                static_cast<double>(hit.t), static_cast<double>(hit.u), static_cast<double>(hit.v),
                static_cast<double>(hit.normal_x), static_cast<double>(hit.normal_y),
                static_cast<double>(hit.normal_z), hit.primitive_id, hit.geometry_id);
  return text;
}

void compare(const std::vector<kiwami_hit>& hits, const std::vector<kiwami_hit>& reference,
             const std::string& where) {
  for (size_t i = 0; i < hits.size(); ++i) {
    if (std::memcmp(&hits[i], &reference[i], sizeof(kiwami_hit)) != 0)
      fail(where + ": ray " + std::to_string(i) + "\n  " + text_of(hits[i]) + "\n  scalar " +
           text_of(reference[i]));
  }
}

/// FNV-1a over the bytes of the answers.
void add_to_digest(uint64_t& digest, const std::vector<kiwami_hit>& hits) {
  const unsigned char* bytes = reinterpret_cast<const unsigned char*>(hits.data());
  for (size_t i = 0; i < hits.size() * sizeof(kiwami_hit); ++i)
    digest = (digest ^ bytes[i]) * 0x100000001B3ull;
}

struct Totals {
  uint64_t traced = 0, hits = 0, digest = 0xCBF29CE484222325ull;
};

/// Every device and native width against the scalar kernels of width 4 without merging.
void check_mesh(const std::vector<kiwami_device*>& devices, const generated::Mesh& mesh,
                const std::vector<kiwami_ray>& rays, Totals& totals) {
  kiwami_scene* plain = scene_of(devices[0], mesh, 4, false);
  const std::vector<kiwami_hit> reference = trace(plain, rays, mesh.name);
  kiwami_scene_release(plain);
  for (const kiwami_hit& hit : reference) totals.hits += hit.primitive_id != KIWAMI_INVALID_ID;
  add_to_digest(totals.digest, reference);
  for (kiwami_device* device : devices) {
    const kiwami_device_info info = info_of(device);
    for (const uint32_t width : kWidths) {
      if (!(info.native_widths & 1u << width)) continue;
      const std::string where =
          std::string(mesh.name) + ", " + kiwami_isa_name(info.isa) + " " + std::to_string(width);
      kiwami_scene* scene = scene_of(device, mesh, width, true);
      compare(trace(scene, rays, where), reference, where);
      kiwami_scene_release(scene);
      totals.traced += rays.size();
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = parse(argc, argv);
  const std::vector<kiwami_device*> devices = devices_up_to(check_choice(options.isa));
  const std::vector<generated::Mesh> meshes = generated::adversarial_meshes(options.seed);
  generated::Random random(options.seed + 1);
  Totals totals;
  for (const generated::Mesh& mesh : meshes) {
    const size_t count = (options.rays + meshes.size() - 1) / meshes.size();
    check_mesh(devices, mesh, generated::adversarial_rays(mesh, count, random), totals);
    std::printf("%s: equal\n", mesh.name);
    std::fflush(stdout);
  }
  for (kiwami_device* device : devices) kiwami_device_release(device);
  std::printf("%" PRIu64 " rays traced, 0 differences; %" PRIu64 " hits, digest %016" PRIx64 "\n",
              totals.traced, totals.hits, totals.digest);
  return 0;
}
