// SPDX-License-Identifier: Apache-2.0
// Trace calls that cannot be right: what is always checked, and what KIWAMI_DEVICE_VALIDATE adds.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

constexpr size_t kHuge = std::numeric_limits<size_t>::max() / 2;

class TraceErrors : public testing::Test {
 protected:
  static Device validating_device() {
    kiwami_device_desc desc = default_device();
    desc.flags = KIWAMI_DEVICE_VALIDATE;
    return make_device(desc);
  }

  void expect_sentence(kiwami_result result, const std::string& sentence) {
    EXPECT_EQ(result, KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(last_error(), sentence);
  }
  void expect_beginning(kiwami_result result, const std::string& beginning) {
    EXPECT_EQ(result, KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(last_error().rfind(beginning, 0), 0u) << last_error();
  }

  const Device device_ = validating_device();
  const Triangles triangles_ = square(1);
  const Scene scene_ = make_scene(device_, make_mesh(device_, triangles_.desc()));
  kiwami_ray rays_[2] = {ray_along_z(0.5f, 0.25f), ray_along_z(9, 9)};
  kiwami_hit hits_[2];
  uint8_t occluded_[2];
};

TEST_F(TraceErrors, ASceneIsNeeded) {
  const std::string sentence = "scene is NULL, expected a valid pointer";
  kiwami_ray_fields rays;
  kiwami_hit_fields hits;
  kiwami_ray_fields_init(&rays, sizeof rays);
  kiwami_hit_fields_init(&hits, sizeof hits);
  const kiwami_output_field occluded{occluded_, 1};
  expect_sentence(kiwami_closest_hit(nullptr, rays_, 0, hits_, 0, 2, nullptr), sentence);
  expect_sentence(kiwami_any_hit(nullptr, rays_, 0, occluded_, 0, 2, nullptr), sentence);
  expect_sentence(kiwami_closest_hit_fields(nullptr, &rays, &hits, 2, nullptr), sentence);
  expect_sentence(kiwami_any_hit_fields(nullptr, &rays, &occluded, 2, nullptr), sentence);
}

TEST_F(TraceErrors, ACommitIsNeeded) {
  const Scene scene = make_scene(device_);
  kiwami_ray_fields rays;
  kiwami_hit_fields hits;
  kiwami_ray_fields_init(&rays, sizeof rays);
  kiwami_hit_fields_init(&hits, sizeof hits);
  const kiwami_output_field occluded{occluded_, 1};
  EXPECT_EQ(kiwami_closest_hit(scene.get(), rays_, 0, hits_, 0, 2, nullptr),
            KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(last_error(device_.get()),
            "scene was never committed, expected a successful kiwami_scene_commit before");
  EXPECT_EQ(kiwami_any_hit(scene.get(), rays_, 0, occluded_, 0, 2, nullptr),
            KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(kiwami_closest_hit_fields(scene.get(), &rays, &hits, 2, nullptr),
            KIWAMI_ERROR_INVALID_STATE);
  EXPECT_EQ(kiwami_any_hit_fields(scene.get(), &rays, &occluded, 2, nullptr),
            KIWAMI_ERROR_INVALID_STATE);
}

TEST_F(TraceErrors, QueryFlagsMustBeKnown) {
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.flags = 4;
  const std::string sentence = "query.flags is 0x4, expected KIWAMI_QUERY_* bits";
  expect_sentence(kiwami_closest_hit(scene_.get(), rays_, 0, hits_, 0, 2, &query), sentence);
  expect_sentence(kiwami_any_hit(scene_.get(), rays_, 0, occluded_, 0, 2, &query), sentence);
  query.struct_size = 4;
  expect_sentence(kiwami_any_hit(scene_.get(), rays_, 0, occluded_, 0, 2, &query),
                  "query.struct_size is 4, expected a multiple of 8 from 8 to 65536");
}

TEST_F(TraceErrors, ArraysMustBeThere) {
  expect_sentence(kiwami_closest_hit(scene_.get(), nullptr, 0, hits_, 0, 2, nullptr),
                  "rays is NULL, expected a valid pointer");
  expect_sentence(kiwami_closest_hit(scene_.get(), rays_, 0, nullptr, 0, 2, nullptr),
                  "hits is NULL, expected a valid pointer");
  expect_sentence(kiwami_any_hit(scene_.get(), rays_, 0, nullptr, 0, 2, nullptr),
                  "occluded is NULL, expected a valid pointer");
}

TEST_F(TraceErrors, StridesMustHoldAnElement) {
  expect_sentence(kiwami_closest_hit(scene_.get(), rays_, 47, hits_, 0, 2, nullptr),
                  "the stride of rays is 47, expected at least 48, or 0 for 48");
  expect_sentence(kiwami_closest_hit(scene_.get(), rays_, 0, hits_, 35, 2, nullptr),
                  "the stride of hits is 35, expected at least 36, or 0 for 36");
}

TEST_F(TraceErrors, ExtentsMustStayWithinTheAddressSpace) {
  expect_beginning(kiwami_closest_hit(scene_.get(), rays_, kHuge, hits_, 0, 4, nullptr),
                   "the 4 elements of rays, 9223372036854775807 bytes apart, reach beyond the "
                   "address space, expected an extent of at most ");
  expect_beginning(kiwami_closest_hit(scene_.get(), rays_, 0, hits_, kHuge, 4, nullptr),
                   "the 4 elements of hits, ");
  expect_beginning(kiwami_any_hit(scene_.get(), rays_, 0, occluded_, kHuge, 4, nullptr),
                   "the 4 elements of occluded, ");
  expect_beginning(kiwami_any_hit(scene_.get(), rays_, 0, occluded_, 0, 2 * kHuge, nullptr),
                   "the 18446744073709551614 elements of rays, 48 bytes apart, ");
}

class FieldErrors : public TraceErrors {
 protected:
  FieldErrors() {
    kiwami_ray_fields_init(&rays_fields_, sizeof rays_fields_);
    kiwami_hit_fields_init(&hit_fields_, sizeof hit_fields_);
    rays_fields_.origin_x = rays_fields_.origin_y = rays_fields_.origin_z = {&zero_, 0};
    rays_fields_.direction_x = rays_fields_.direction_y = rays_fields_.direction_z = {&zero_, 0};
  }

  kiwami_result closest() {
    return kiwami_closest_hit_fields(scene_.get(), &rays_fields_, &hit_fields_, 2, nullptr);
  }
  kiwami_result any() {
    return kiwami_any_hit_fields(scene_.get(), &rays_fields_, &answers_, 2, nullptr);
  }

  const float zero_ = 0;
  kiwami_ray_fields rays_fields_;
  kiwami_hit_fields hit_fields_;
  kiwami_output_field answers_{occluded_, 1};
};

TEST_F(FieldErrors, OriginAndDirectionMustBeThere) {
  const struct {
    kiwami_input_field kiwami_ray_fields::*field;
    const char* name;
  } needed[] = {{&kiwami_ray_fields::origin_x, "origin_x"},
                {&kiwami_ray_fields::origin_y, "origin_y"},
                {&kiwami_ray_fields::origin_z, "origin_z"},
                {&kiwami_ray_fields::direction_x, "direction_x"},
                {&kiwami_ray_fields::direction_y, "direction_y"},
                {&kiwami_ray_fields::direction_z, "direction_z"}};
  for (const auto& [field, name] : needed) {
    const kiwami_input_field before = rays_fields_.*field;
    rays_fields_.*field = {nullptr, 0};
    const std::string sentence =
        "rays." + std::string(name) + ".data is NULL, expected a valid pointer";
    expect_sentence(closest(), sentence);
    expect_sentence(any(), sentence);
    EXPECT_EQ(kiwami_any_hit_fields(scene_.get(), &rays_fields_, &answers_, 0, nullptr), KIWAMI_OK);
    rays_fields_.*field = before;
  }
  EXPECT_EQ(closest(), KIWAMI_OK);
}

TEST_F(FieldErrors, TheStructsMustBeThere) {
  expect_sentence(kiwami_closest_hit_fields(scene_.get(), nullptr, &hit_fields_, 2, nullptr),
                  "rays is NULL, expected a valid pointer");
  expect_sentence(kiwami_closest_hit_fields(scene_.get(), &rays_fields_, nullptr, 2, nullptr),
                  "hits is NULL, expected a valid pointer");
  expect_sentence(kiwami_any_hit_fields(scene_.get(), &rays_fields_, nullptr, 2, nullptr),
                  "occluded is NULL, expected a valid pointer");
}

TEST_F(FieldErrors, ReservedFieldsAreZero) {
  rays_fields_.reserved = 3;
  expect_sentence(any(), "rays.reserved is 3, expected 0");
  rays_fields_.reserved = 0;
  hit_fields_.reserved = 4;
  expect_sentence(closest(), "hits.reserved is 4, expected 0");
}

TEST_F(FieldErrors, StridesAndExtents) {
  hit_fields_.v = {hits_, 3};
  expect_sentence(closest(), "the stride of hits.v is 3 for 2 rays, expected at least 4");
  hit_fields_.v = {hits_, std::numeric_limits<uint64_t>::max()};
  expect_beginning(closest(), "the 2 elements of hits.v, ");
  hit_fields_.v = {nullptr, 0};
  rays_fields_.tmax = {&zero_, std::numeric_limits<uint64_t>::max()};
  expect_beginning(any(), "the 2 elements of rays.tmax, ");
  rays_fields_.tmax = {nullptr, 0};
  answers_.stride = std::numeric_limits<uint64_t>::max();
  expect_beginning(any(), "the 2 elements of occluded.data, ");
}

}  // namespace
}  // namespace kiwami_api_tests
