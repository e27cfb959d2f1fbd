// SPDX-License-Identifier: Apache-2.0
// Rays and answers with their fields apart: the same bits as arrays of structs give.
#include <gtest/gtest.h>

#include <cstdlib>
#include <cstring>
#include <memory>

#include "api/api_support.h"
#include "support/environment.h"

namespace kiwami_api_tests {
namespace {

struct Free {
  void operator()(void* memory) const { std::free(memory); }
};

/// A column of 4-byte values in memory of exactly its size, at an odd address.
class Column {
 public:
  Column(size_t count, size_t stride)
      : stride_(stride), memory_(std::malloc(1 + (count == 0 ? 0 : (count - 1) * stride + 4))) {}

  void* data() const { return static_cast<char*>(memory_.get()) + 1; }
  uint64_t stride() const { return stride_; }
  template <typename T>
  void set(size_t i, T value) {
    std::memcpy(static_cast<char*>(data()) + i * stride_, &value, sizeof value);
  }
  uint32_t bits(size_t i) const {
    uint32_t value;
    std::memcpy(&value, static_cast<char*>(data()) + i * stride_, sizeof value);
    return value;
  }

 private:
  size_t stride_;
  std::unique_ptr<void, Free> memory_;
};

class FieldTraceTest : public testing::TestWithParam<size_t> {
 protected:
  const size_t count_ = GetParam();
  const Device device_ = make_device();
  const Triangles triangles_ = random_triangles(400, kiwami_tests::seed());
  const Scene scene_ = make_scene(device_, make_mesh(device_, triangles_.desc()));
  const std::vector<kiwami_ray> rays_ = random_rays(count_, kiwami_tests::seed());
  std::vector<Column> columns_;  // keeps the inputs

  template <typename T>
  kiwami_input_field column_of(T kiwami_ray::*member, size_t stride) {
    columns_.emplace_back(count_, stride);
    for (size_t i = 0; i < count_; ++i) columns_.back().set(i, rays_[i].*member);
    return {columns_.back().data(), stride};
  }

  kiwami_ray_fields ray_columns() {
    kiwami_ray_fields fields;
    kiwami_ray_fields_init(&fields, sizeof fields);
    fields.origin_x = column_of(&kiwami_ray::origin_x, 4);
    fields.origin_y = column_of(&kiwami_ray::origin_y, 5);
    fields.origin_z = column_of(&kiwami_ray::origin_z, 12);
    fields.direction_x = column_of(&kiwami_ray::direction_x, 4);
    fields.direction_y = column_of(&kiwami_ray::direction_y, 7);
    fields.direction_z = column_of(&kiwami_ray::direction_z, 16);
    fields.tmin = column_of(&kiwami_ray::tmin, 4);
    fields.tmax = column_of(&kiwami_ray::tmax, 9);
    fields.time = column_of(&kiwami_ray::time, 4);
    fields.mask = column_of(&kiwami_ray::mask, 4);
    fields.flags = column_of(&kiwami_ray::flags, 6);
    return fields;
  }
};

TEST_P(FieldTraceTest, ClosestHitGivesTheBitsOfTheArrayForm) {
  const std::vector<kiwami_hit> expected = closest_hits(scene_, rays_);
  const kiwami_ray_fields rays = ray_columns();
  std::vector<Column> outputs;
  for (size_t field = 0; field < 9; ++field) outputs.emplace_back(count_, 4 + field);
  kiwami_hit_fields hits;
  kiwami_hit_fields_init(&hits, sizeof hits);
  kiwami_output_field* fields[9] = {&hits.t,
                                    &hits.u,
                                    &hits.v,
                                    &hits.normal_x,
                                    &hits.normal_y,
                                    &hits.normal_z,
                                    &hits.primitive_id,
                                    &hits.geometry_id,
                                    &hits.instance_id};
  for (size_t field = 0; field < 9; ++field) {
    *fields[field] = {outputs[field].data(), outputs[field].stride()};
  }
  ASSERT_EQ(kiwami_closest_hit_fields(scene_.get(), &rays, &hits, count_, nullptr), KIWAMI_OK)
      << last_error();
  for (size_t i = 0; i < count_; ++i) {
    uint32_t bits[9];
    std::memcpy(bits, &expected[i], sizeof bits);
    for (size_t field = 0; field < 9; ++field) {
      ASSERT_EQ(outputs[field].bits(i), bits[field]) << "ray " << i << ", field " << field;
    }
  }
}

TEST_P(FieldTraceTest, AnyHitGivesTheBytesOfTheArrayForm) {
  std::vector<uint8_t> expected(count_, 7), occluded(3 * count_, 7);
  kiwami_any_hit(scene_.get(), rays_.data(), 0, expected.data(), 0, count_, nullptr);
  const kiwami_ray_fields rays = ray_columns();
  const kiwami_output_field strided{occluded.data(), 3};
  ASSERT_EQ(kiwami_any_hit_fields(scene_.get(), &rays, &strided, count_, nullptr), KIWAMI_OK);
  for (size_t i = 0; i < count_; ++i) {
    ASSERT_EQ(occluded[3 * i], expected[i]) << i;
    ASSERT_EQ(occluded[3 * i + 1], 7);
  }
  const kiwami_output_field dense{occluded.data(), 0};
  ASSERT_EQ(kiwami_any_hit_fields(scene_.get(), &rays, &dense, count_, nullptr), KIWAMI_OK);
  occluded.resize(count_);
  EXPECT_EQ(occluded, expected);
}

TEST_P(FieldTraceTest, AbsentFieldsHaveDefaultsAndAStrideOfZeroRepeatsOne) {
  std::vector<kiwami_ray> plain = rays_;
  for (kiwami_ray& ray : plain) {
    ray.origin_x = 0.125f;
    ray.tmin = 0;
    ray.tmax = kInfinity;
    ray.time = 0;
    ray.mask = ~0u;
    ray.flags = 0;
  }
  const std::vector<kiwami_hit> expected = closest_hits(scene_, plain);
  kiwami_ray_fields rays = ray_columns();
  const float everywhere = 0.125f;
  rays.origin_x = {&everywhere, 0};
  rays.tmin = rays.tmax = rays.time = rays.mask = rays.flags = {nullptr, 4};
  std::vector<float> t(count_);
  kiwami_hit_fields hits;
  kiwami_hit_fields_init(&hits, sizeof hits);
  hits.t = {t.data(), 4};
  ASSERT_EQ(kiwami_closest_hit_fields(scene_.get(), &rays, &hits, count_, nullptr), KIWAMI_OK);
  for (size_t i = 0; i < count_; ++i) {
    ASSERT_EQ(std::memcmp(&t[i], &expected[i].t, 4), 0) << i;
  }
}

TEST_P(FieldTraceTest, NothingNeedsToBeWanted) {
  const kiwami_ray_fields rays = ray_columns();
  kiwami_hit_fields hits;
  kiwami_hit_fields_init(&hits, sizeof hits);
  const kiwami_output_field none{nullptr, 0};
  EXPECT_EQ(kiwami_closest_hit_fields(scene_.get(), &rays, &hits, count_, nullptr), KIWAMI_OK);
  EXPECT_EQ(kiwami_any_hit_fields(scene_.get(), &rays, &none, count_, nullptr), KIWAMI_OK);
}

// Around the sizes of a chunk, of a block, and of a batch that runs in parallel.
INSTANTIATE_TEST_SUITE_P(Counts, FieldTraceTest,
                         testing::Values(0, 1, 2, 63, 64, 65, 1000, 4095, 4096, 5000));

}  // namespace
}  // namespace kiwami_api_tests
