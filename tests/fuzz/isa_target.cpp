// SPDX-License-Identifier: Apache-2.0
// Any triangles and any rays: every instruction set and every node width gives the same answers, to
// the bit.
#include <cmath>
#include <limits>

#include "fuzz/handles.h"
#include "support/random.h"

namespace kiwami_fuzz {
namespace {

constexpr uint32_t kMostTriangles = 48;
constexpr uint32_t kMostRays = 24;

struct Case {
  std::vector<float> corners;
  std::vector<kiwami_ray> rays;
  uint32_t mask;
};

/// A number as it stands in the input, or one of a small grid, where edges and vertices coincide
/// and rays meet them.
float take_float(Input& input) {
  const auto form = input.take<uint8_t>();
  if (form < 32) return input.take<float>();
  if (form < 48) return std::ldexp(static_cast<float>(input.take<int8_t>()), form - 40);
  return static_cast<float>(form % 8) * 0.5f - 1.5f;
}

Case take_case(Input& input) {
  Case made;
  made.mask = input.below(4) == 0 ? input.take<uint32_t>() : ~0u;
  const uint32_t triangles = 1 + input.below(kMostTriangles), rays = 1 + input.below(kMostRays);
  for (uint32_t i = 0; i < 9 * triangles; ++i) made.corners.push_back(take_float(input));
  for (uint32_t i = 0; i < rays; ++i) {
    kiwami_ray ray{};
    for (float* field : {&ray.origin_x, &ray.origin_y, &ray.origin_z, &ray.direction_x,
                         &ray.direction_y, &ray.direction_z}) {
      *field = take_float(input);
    }
    const auto form = input.take<uint8_t>();
    ray.tmin = form % 4 == 1 ? take_float(input) : 0.0f;
    ray.tmax = form % 4 == 2 ? take_float(input) : std::numeric_limits<float>::infinity();
    ray.mask = form % 16 == 3 ? input.take<uint32_t>() : ~0u;
    ray.flags = form / 64;
    made.rays.push_back(ray);
  }
  return made;
}

struct Answers {
  std::vector<kiwami_hit> closest;
  std::vector<uint8_t> any;
  std::vector<uint32_t> counts;
};

Answers answer(const Device& device, uint32_t width, const Case& given) {
  kiwami_triangle_mesh_desc desc;
  kiwami_triangle_mesh_desc_init(&desc, sizeof desc);
  desc.vertices = given.corners.data();
  desc.vertex_count = given.corners.size() / 3;
  desc.triangle_count = given.corners.size() / 9;
  desc.mask = given.mask;
  kiwami_geometry* mesh = nullptr;
  kiwami_scene* made = nullptr;
  require(kiwami_triangle_mesh_create(device.get(), &desc, &mesh) == KIWAMI_OK, "no mesh");
  const Geometry owner(mesh);
  require(kiwami_scene_create(device.get(), &made) == KIWAMI_OK, "no scene");
  const Scene scene(made);
  kiwami_scene_attach(made, mesh, nullptr);
  kiwami_scene_set_parameter(made, KIWAMI_PARAMETER_BVH_WIDTH, width);
  require(kiwami_scene_commit(made) == KIWAMI_OK, "a commit that fails");
  require(kiwami_scene_validate(made) == KIWAMI_OK, "a tree that is not valid");
  const size_t count = given.rays.size();
  Answers answers{std::vector<kiwami_hit>(count), std::vector<uint8_t>(count),
                  std::vector<uint32_t>(count)};
  kiwami_closest_hit(made, given.rays.data(), 0, answers.closest.data(), 0, count, nullptr);
  kiwami_any_hit(made, given.rays.data(), 0, answers.any.data(), 0, count, nullptr);
  kiwami_count_hits(made, given.rays.data(), 0, answers.counts.data(), 0, count, nullptr);
  return answers;
}

void compare(const Answers& a, const Answers& b) {
  const size_t count = a.any.size();
  require(std::memcmp(a.closest.data(), b.closest.data(), count * sizeof(kiwami_hit)) == 0,
          "closest hits that differ");
  require(a.any == b.any, "any hits that differ");
  require(a.counts == b.counts, "counts that differ");
  for (size_t i = 0; i < count; ++i) {
    const bool has_hit = a.closest[i].primitive_id != KIWAMI_INVALID_ID;
    require(has_hit == (a.any[i] != 0) && has_hit == (a.counts[i] != 0), "queries that disagree");
  }
}

std::vector<Device> make_devices() {
  std::vector<Device> devices;
  devices.push_back(make_device(KIWAMI_ISA_SCALAR, 0, nullptr));
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  kiwami_device_get_info(devices[0].get(), &info);
  for (uint32_t isa = KIWAMI_ISA_SSE; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if (info.isa_available >> isa & 1) devices.push_back(make_device(isa, 0, nullptr));
  }
  return devices;
}

}  // namespace

std::vector<Bytes> make_seeds() {
  std::vector<Bytes> seeds;
  kiwami_tests::Random random(3);
  for (const size_t size : {40u, 200u, 800u, 1500u}) {
    for (int i = 0; i < 8; ++i) {
      Bytes seed(size);
      for (unsigned char& byte : seed) byte = static_cast<unsigned char>(random.bits());
      seeds.push_back(seed);
    }
  }
  return seeds;
}

}  // namespace kiwami_fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace kiwami_fuzz;
  static const std::vector<Device> devices = make_devices();
  Input input(data, size);
  const Case given = take_case(input);
  const Answers expected = answer(devices[0], 4, given);
  for (const Device& device : devices) {
    for (const uint32_t width : {4u, 8u, 16u}) compare(expected, answer(device, width, given));
  }
  return 0;
}
