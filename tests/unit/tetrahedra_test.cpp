// SPDX-License-Identifier: Apache-2.0
// What is inside of kiwami_tetrahedra: exact volumes, and the candidates that rays find.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>

#include "core/device.h"
#include "support/environment.h"
#include "support/kuhn_grid.h"
#include "tetrahedra/face_tracer.h"
#include "tetrahedra/volume.h"

namespace kiwami_tests {
namespace {

using kiwami::Vec3f;

__extension__ typedef __int128 Wide;  // NOLINT(modernize-use-using)

/// A whole number below 2^38 that is a float: 24 digits at any place.
int64_t random_whole(Random& random) {
  const auto digits = static_cast<int64_t>(random.bits() >> 8) >> random.below(24);
  return (random.one_in(2) ? digits : -digits) * (int64_t{1} << random.below(14));
}

Wide determinant(const int64_t (&p)[4][3]) {
  const auto along = [&](int i, int axis) { return Wide{p[i][axis]} - p[0][axis]; };
  return along(1, 0) * (along(2, 1) * along(3, 2) - along(2, 2) * along(3, 1)) +
         along(1, 1) * (along(2, 2) * along(3, 0) - along(2, 0) * along(3, 2)) +
         along(1, 2) * (along(2, 0) * along(3, 1) - along(2, 1) * along(3, 0));
}

TEST(Volume, HasTheExactSign) {
  Random random(seed(), 710);
  int zeros = 0;
  for (uint64_t i = 0; i < ray_budget(100000); ++i) {
    int64_t whole[4][3];
    for (auto& point : whole) {
      for (int64_t& at : point) at = random_whole(random);
    }
    // Often in one plane, or as good as that: a sum of two corners less a third, next to its place.
    if (random.one_in(2)) {
      for (int axis = 0; axis < 3; ++axis) {
        whole[1][axis] >>= 15;
        whole[2][axis] >>= 15;
        whole[0][axis] >>= 15;
        whole[3][axis] = whole[1][axis] + whole[2][axis] - whole[0][axis];
      }
      if (random.one_in(2)) whole[3][random.below(3)] += random.between(-1, 1);
    }
    Vec3f corner[4];
    for (int k = 0; k < 4; ++k) {
      for (int axis = 0; axis < 3; ++axis) {
        corner[k][axis] = static_cast<float>(whole[k][axis]);
        ASSERT_EQ(static_cast<int64_t>(corner[k][axis]), whole[k][axis]);
      }
    }
    const double volume = kiwami::exact_volume(corner[0], corner[1], corner[2], corner[3]);
    const Wide expected = determinant(whole);
    ASSERT_EQ(volume > 0.0, expected > 0) << "case " << i << ", seed " << seed();
    ASSERT_EQ(volume < 0.0, expected < 0) << "case " << i << ", seed " << seed();
    const double quick = kiwami::signed_volume(corner[0], corner[1], corner[2], corner[3]);
    ASSERT_EQ(quick > 0.0, expected > 0) << "case " << i << ", seed " << seed();
    ASSERT_EQ(quick < 0.0, expected < 0) << "case " << i << ", seed " << seed();
    const auto rounded = static_cast<double>(expected);
    ASSERT_NEAR(volume, rounded, 0x1p-47 * std::fabs(rounded));
    zeros += expected == 0 ? 1 : 0;
  }
  EXPECT_GT(zeros, 0);
}

TEST(FaceTracer, FindsTheTetrahedronOfEveryInnerPoint) {
  Random random(seed(), 711);
  const TetrahedralGrid grid = kuhn_grid(6, 1 << 16, 5000, random);
  kiwami_device_desc desc{};
  desc.struct_size = sizeof desc;
  const auto device = kiwami::Reference<kiwami::Device>::adopt(kiwami::Device::create(desc));
  kiwami::TetrahedronSource source;
  const std::vector<float> floats = grid.coordinates(1.0f);
  source.vertices = kiwami::Array<Vec3f>(device->memory(), grid.vertices.size());
  std::memcpy(source.vertices.data(), floats.data(), floats.size() * sizeof(float));
  source.tetrahedra = kiwami::Array<kiwami::Tetrahedron>(device->memory(), grid.tetrahedra.size());
  std::memcpy(source.tetrahedra.data(), grid.tetrahedra.data(), source.tetrahedra.bytes());
  source.has_volume = kiwami::Array<uint8_t>(device->memory(), grid.tetrahedra.size());
  std::fill(source.has_volume.begin(), source.has_volume.end(), uint8_t{1});
  const kiwami::FaceTracer tracer(source, *device);
  for (uint64_t round = 0; round < ray_budget(40); ++round) {
    Vec3f points[kiwami::FaceTracer::kMostPoints];
    for (Vec3f& point : points) {
      for (int axis = 0; axis < 3; ++axis) {
        point[axis] = random.unit() * static_cast<float>(grid.extent);
      }
    }
    uint32_t ids[kiwami::FaceTracer::kMostPoints];
    tracer.find_candidates(points, kiwami::FaceTracer::kMostPoints, ids);
    for (size_t i = 0; i < kiwami::FaceTracer::kMostPoints; ++i) {
      ASSERT_LT(ids[i], grid.tetrahedra.size());
      Vec3f corner[4];
      source.corners_of(ids[i], corner);
      float weights[4];
      ASSERT_NE(kiwami::place_point(corner, points[i], weights), kiwami::PointPlace::kOutside)
          << "point " << i << " of round " << round << ", seed " << seed();
    }
  }
}

}  // namespace
}  // namespace kiwami_tests
