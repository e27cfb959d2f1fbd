// SPDX-License-Identifier: Apache-2.0
// Devices: the choice of the ISA, and each error of their description.
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

/// Sets the environment variable KIWAMI_ISA while it lives.
class IsaVariable {
 public:
  explicit IsaVariable(const char* value) {
    const char* before = std::getenv("KIWAMI_ISA");
    was_set_ = before != nullptr;
    if (before) before_ = before;
    setenv("KIWAMI_ISA", value, 1);
  }
  ~IsaVariable() {
    if (was_set_) {
      setenv("KIWAMI_ISA", before_.c_str(), 1);
    } else {
      unsetenv("KIWAMI_ISA");
    }
  }

 private:
  bool was_set_;
  std::string before_;
};

kiwami_device_info info_of(const Device& device) {
  kiwami_device_info info{};
  info.struct_size = sizeof info;
  EXPECT_EQ(kiwami_device_get_info(device.get(), &info), KIWAMI_OK) << last_error();
  return info;
}

void expect_error(const kiwami_device_desc& desc, kiwami_result result, const std::string& text) {
  kiwami_device* device = reinterpret_cast<kiwami_device*>(uintptr_t{8});
  EXPECT_EQ(kiwami_device_create(&desc, &device), result) << text;
  EXPECT_EQ(device, nullptr);
  EXPECT_EQ(last_error(), text);
}

TEST(Device, IsaNames) {
  EXPECT_STREQ(kiwami_isa_name(KIWAMI_ISA_AUTO), "auto");
  EXPECT_STREQ(kiwami_isa_name(KIWAMI_ISA_SCALAR), "scalar");
  EXPECT_STREQ(kiwami_isa_name(KIWAMI_ISA_SSE), "sse");
  EXPECT_STREQ(kiwami_isa_name(KIWAMI_ISA_AVX2), "avx2");
  EXPECT_STREQ(kiwami_isa_name(KIWAMI_ISA_AVX512), "avx512");
  EXPECT_STREQ(kiwami_isa_name(5), "unknown");
}

TEST(Device, TheBestIsaOfTheMachineRuns) {
  const IsaVariable variable("");
  const kiwami_device_info info = info_of(make_device(KIWAMI_ISA_AUTO));
  EXPECT_EQ(info.isa_available & ~info.isa_built, 0u);
  EXPECT_EQ(info.isa_available >> info.isa, 1u) << "a better ISA is available";
  EXPECT_NE(info.isa_available & 1u << KIWAMI_ISA_SCALAR, 0u);
  EXPECT_NE(info.native_widths, 0u);
  EXPECT_NE(info.native_widths >> info.default_bvh_width & 1, 0u);
  EXPECT_GE(info.thread_count, 1u);
  EXPECT_EQ(info.reserved, 0u);
}

TEST(Device, EveryAvailableIsaCanBeChosenAndTheOthersAreErrors) {
  const uint32_t available = info_of(make_device(KIWAMI_ISA_SCALAR)).isa_available;
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if (available >> isa & 1) {
      EXPECT_EQ(info_of(make_device(isa)).isa, isa);
      continue;
    }
    kiwami_device_desc desc = default_device();
    desc.isa = isa;
    kiwami_device* device = nullptr;
    EXPECT_EQ(kiwami_device_create(&desc, &device), KIWAMI_ERROR_UNSUPPORTED_ISA);
    EXPECT_NE(last_error().find("desc.isa is " + std::string(kiwami_isa_name(isa))),
              std::string::npos);
    EXPECT_NE(last_error().find("expected one of: scalar"), std::string::npos);
  }
}

TEST(Device, TheVariableDecidesWhenTheDescriptionDoesNot) {
  const IsaVariable variable("scalar");
  EXPECT_EQ(info_of(make_device(KIWAMI_ISA_AUTO)).isa, uint32_t{KIWAMI_ISA_SCALAR});
}

TEST(Device, TheDescriptionOverridesTheVariable) {
  const IsaVariable variable("nonsense");
  EXPECT_EQ(info_of(make_device(KIWAMI_ISA_SCALAR)).isa, uint32_t{KIWAMI_ISA_SCALAR});
}

TEST(Device, AnUnknownNameInTheVariableIsAnError) {
  const IsaVariable variable("AVX-1024");
  expect_error(default_device(), KIWAMI_ERROR_INVALID_ARGUMENT,
               "the environment variable KIWAMI_ISA is 'AVX-1024', expected auto, scalar, sse, "
               "avx2 or avx512");
}

TEST(Device, DefaultsServeWithoutADescription) {
  kiwami_device* device = nullptr;
  ASSERT_EQ(kiwami_device_create(nullptr, &device), KIWAMI_OK) << last_error();
  ASSERT_NE(device, nullptr);
  kiwami_device_release(device);
}

TEST(Device, NullHandlesAreIgnored) {
  kiwami_device_retain(nullptr);
  kiwami_device_release(nullptr);
  EXPECT_EQ(kiwami_device_create(nullptr, nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(last_error(), "device is NULL, expected a valid pointer");
}

TEST(Device, EachBadFieldIsNamed) {
  kiwami_device_desc desc = default_device();
  desc.isa = 5;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.isa is 5, expected one of KIWAMI_ISA_*");
  desc = default_device();
  desc.flags = 6;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc.flags is 0x6, expected KIWAMI_DEVICE_* bits");
  desc = default_device();
  desc.reserved = 1;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is 1, expected 0");
  desc = default_device();
  desc.thread_count = 1025;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc.thread_count is 1025, expected at most 1024");

  CountingAllocator allocator;
  desc = default_device();
  allocator.install(desc);
  desc.deallocate = nullptr;
  expect_error(desc, KIWAMI_ERROR_INVALID_ARGUMENT,
               "desc.deallocate is NULL, expected desc.allocate and desc.deallocate both or none");
}

TEST(Device, LogReceivesErrorsAndNotes) {
  struct Lines {
    std::string text;
    static void add(void* user, kiwami_result severity, const char* sentence) {
      static_cast<Lines*>(user)->text += std::to_string(severity) + ": " + sentence + "\n";
    }
  } lines;
  kiwami_device_desc desc = default_device();
  desc.log = &Lines::add;
  desc.log_user = &lines;
  const Device device = make_device(desc);
  Triangles triangles = square(1);
  triangles.vertices[3] = kInfinity;  // of vertex 1, which the second triangle does not have
  const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
  EXPECT_EQ(kiwami_scene_detach(scene.get(), 8), KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_EQ(lines.text,
            "0: commit skipped 1 of 2 triangles for a vertex that is NaN, infinite or beyond "
            "KIWAMI_MAX_COORDINATE\n"
            "-1: geometry_id is 8, expected the number of an attached geometry\n");
}

TEST(Device, TwoIsasInOneProcessGiveTheSameBits) {
  const uint32_t available = info_of(make_device(KIWAMI_ISA_SCALAR)).isa_available;
  const Triangles triangles = random_triangles(500, 1);
  const std::vector<kiwami_ray> rays = random_rays(2000, 2);
  const Device scalar = make_device(KIWAMI_ISA_SCALAR);
  const Scene scalar_scene = make_scene(scalar, make_mesh(scalar, triangles.desc()));
  const std::vector<kiwami_hit> expected = closest_hits(scalar_scene, rays);
  for (uint32_t isa = KIWAMI_ISA_SCALAR; isa <= KIWAMI_ISA_AVX512; ++isa) {
    if ((available >> isa & 1) == 0) continue;
    const Device device = make_device(isa);
    for (double width : {4, 8, 16}) {
      const Geometry mesh = make_mesh(device, triangles.desc());
      const Scene scene = make_scene(device);
      kiwami_scene_attach(scene.get(), mesh.get(), nullptr);
      kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width);
      ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
      EXPECT_TRUE(are_equal(closest_hits(scene, rays), expected)) << isa << " " << width;
    }
  }
}

}  // namespace
}  // namespace kiwami_api_tests
