// SPDX-License-Identifier: Apache-2.0
// Functions that the library calls back, and what they throw.
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <string>
#include <thread>

#include "support.h"

namespace {

struct Stop {
  int why;
};

TEST(Callbacks, ProgressIsToldAndMayCancelOrThrow) {
  const kiwami::Device device;
  kiwami::Scene scene = scene_of_one_triangle(device);
  std::vector<double> fractions;
  scene.commit([&](double fraction) {
    fractions.push_back(fraction);
    return false;
  });
  ASSERT_GE(fractions.size(), 2u);
  EXPECT_EQ(fractions.front(), 0.0);
  EXPECT_EQ(fractions.back(), 1.0);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  try {
    scene.commit([](double) { return true; });
    FAIL() << "the commit was not cancelled";
  } catch (const kiwami::Error& error) {
    EXPECT_EQ(error.result(), KIWAMI_ERROR_CANCELLED);
  }
  int calls = 0;
  try {
    scene.commit([&](double) -> bool {
      ++calls;
      throw Stop{7};
    });
    FAIL() << "nothing was thrown";
  } catch (const Stop& stop) {
    EXPECT_EQ(stop.why, 7);
  }
  EXPECT_EQ(calls, 1);
  // The function is gone, and what was committed before stays in use.
  EXPECT_TRUE(scene.any_hit(ray_at(0.25f, 0.25f)));
  scene.commit();
  EXPECT_EQ(calls, 1);
  note("progress callback");
}

/// Eight triangles, one behind the other.
kiwami::Scene layers(const kiwami::Device& device) {
  std::vector<kiwami::Vertex> vertices;
  std::vector<kiwami::Triangle> triangles;
  for (std::uint32_t i = 0; i < 8; ++i) {
    const auto z = static_cast<float>(i);
    vertices.insert(vertices.end(), {{-1, -1, z}, {3, -1, z}, {-1, 3, z}});
    triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  kiwami::Scene scene(device);
  scene.attach(kiwami::Mesh(device, vertices, triangles));
  scene.commit();
  return scene;
}

TEST(Callbacks, FiltersAcceptRejectAndStop) {
  const kiwami::Device device;
  const kiwami::Scene scene = layers(device);
  const std::vector<kiwami::Ray> rays(3000, ray_at(0, 0));
  std::atomic<int> calls{0};
  const auto odd = [&](const kiwami::FilterCandidate& candidate) {
    ++calls;
    return candidate.hit.primitive_id % 2 == 1;
  };
  for (const kiwami::Hit& hit : scene.closest_hit(rays, odd)) EXPECT_EQ(hit.primitive_id, 1u);
  EXPECT_GE(calls.load(), 3000);
  EXPECT_EQ(scene.closest_hit(ray_at(0, 0), odd).t, 2.0f);
  for (const std::uint8_t each : scene.any_hit(rays, odd)) EXPECT_EQ(each, 1);
  EXPECT_FALSE(scene.any_hit(ray_at(0, 0), [](const auto&) { return false; }));
  for (const std::uint32_t count : scene.count_hits(rays, odd)) EXPECT_EQ(count, 4u);
  const kiwami::MultiHits found = scene.multi_hit(rays, 0, odd);
  ASSERT_EQ(found.of(2999).size(), 4u);
  EXPECT_EQ(found.of(2999)[3].primitive_id, 7u);
  const auto stop = [](const auto&) { return KIWAMI_FILTER_ACCEPT_AND_STOP; };
  EXPECT_EQ(scene.count_hits(rays, stop).front(), 1u);
  // Beside a query of the C interface.
  const kiwami_exclusion exclusion{1, 0, KIWAMI_INVALID_ID};
  kiwami_query query;
  ASSERT_EQ(kiwami_query_init(&query, sizeof(query)), KIWAMI_OK);
  query.exclusions = &exclusion;
  EXPECT_EQ(scene.closest_hit(ray_at(0, 0), kiwami::Query(odd, &query)).primitive_id, 3u);
  EXPECT_EQ(scene.closest_hit(ray_at(0, 0), &query).primitive_id, 0u);
  note("filter callback");
}

TEST(Callbacks, WhatAFilterThrowsComesOutOfTheCall) {
  const kiwami::Device device;
  const kiwami::Scene scene = layers(device);
  const std::vector<kiwami::Ray> rays(3000, ray_at(0, 0));
  const auto fail = [](const kiwami::FilterCandidate&) -> bool { throw Stop{7}; };
  EXPECT_THROW(scene.closest_hit(rays, fail), Stop);
  EXPECT_THROW(scene.any_hit(rays, fail), Stop);
  EXPECT_THROW(scene.multi_hit(rays, 0, fail), Stop);
  EXPECT_THROW(scene.count_hits(rays, fail), Stop);
  EXPECT_THROW(scene.any_hit(ray_at(0, 0), [](const auto&) { return 7; }), kiwami::Error);
  EXPECT_TRUE(scene.any_hit(ray_at(0, 0)));
}

/// Squares of side 2 across z = 0, 1, ..., that count how many of them live.
class Squares {
 public:
  explicit Squares(std::shared_ptr<int> alive) : alive_(std::move(alive)) {}
  void bounds(std::uint32_t first, std::span<kiwami::Bounds> bounds) const {
    if (throws_in_bounds) throw Stop{1};
    for (std::size_t i = 0; i < bounds.size(); ++i) {
      const auto z = static_cast<float>(first + i);
      bounds[i] = {{-1, -1, z}, {1, 1, z}};
    }
  }
  void intersect(kiwami::Intersection& intersection) const {
    const kiwami::Ray& ray = intersection.ray();
    if (ray.origin_x == throws_at) throw Stop{2};
    for (const std::uint32_t square : intersection.primitive_ids()) {
      const float t = (static_cast<float>(square) - ray.origin_z) / ray.direction_z;
      const float x = ray.origin_x + t * ray.direction_x, y = ray.origin_y + t * ray.direction_y;
      if (std::abs(x) > 1 || std::abs(y) > 1) continue;
      intersection.add({t, x, y, 0, 0, -1, square, 0});
      if (adds_too_many) {
        for (int i = 0; i < 100; ++i) intersection.add({t, x, y, 0, 0, -1, square, 0});
      }
    }
  }
  float throws_at = -5;
  bool throws_in_bounds = false, adds_too_many = false;

 private:
  std::shared_ptr<int> alive_;
};

TEST(Callbacks, UserGeometriesAreBoundedAndIntersected) {
  const kiwami::Device device;
  const auto alive = std::make_shared<int>();
  {
    kiwami::Scene scene(device);
    scene.attach(kiwami::Mesh(device, kCorners, std::span(&kTriangle, 1)));
    EXPECT_EQ(scene.attach(kiwami::UserGeometry(device, 40, Squares(alive), 2)), 1u);
    scene.commit();
    const std::vector<kiwami::Ray> rays(3000, ray_at(0.75f, -0.5f));
    const kiwami::Hit hit = scene.closest_hit(rays).back();
    EXPECT_EQ(hit.t, 1.0f);
    EXPECT_EQ(std::bit_cast<Bits>(hit),
              std::bit_cast<Bits>(kiwami::Hit{1, 0.75f, -0.5f, 0, 0, -1, 0, 1, KIWAMI_INVALID_ID}));
    EXPECT_EQ(scene.count_hits(rays).front(), 40u);
    EXPECT_FALSE(scene.any_hit(ray_at(1.5f, 0)));
    kiwami::Ray masked = ray_at(0.75f, -0.5f);
    masked.mask = 1;
    EXPECT_FALSE(scene.any_hit(masked));
    EXPECT_EQ(alive.use_count(), 2);
    scene.detach(1);
    EXPECT_EQ(alive.use_count(), 2);  // what was committed holds it
    EXPECT_TRUE(scene.any_hit(rays.front()));
  }
  EXPECT_EQ(alive.use_count(), 1);
  note("user geometry callback");
}

TEST(Callbacks, WhatUserGeometriesThrowComesOutOfTheCall) {
  const kiwami::Device device;
  const auto alive = std::make_shared<int>();
  Squares squares(alive);
  squares.throws_in_bounds = true;
  kiwami::Scene scene(device);
  scene.attach(kiwami::UserGeometry(device, 40, squares));
  EXPECT_THROW(scene.commit(), Stop);
  EXPECT_THROW(scene.commit([](double) { return false; }), Stop);
  squares.throws_in_bounds = false;
  squares.throws_at = 0.5f;
  scene.replace(0, kiwami::UserGeometry(device, 40, squares));
  scene.commit();
  std::vector<kiwami::Ray> rays(3000, ray_at(0.25f, 0));
  EXPECT_TRUE(scene.any_hit(rays).back());
  rays[2000] = ray_at(0.5f, 0);
  EXPECT_THROW(scene.closest_hit(rays), Stop);
  EXPECT_THROW(scene.any_hit(rays), Stop);
  EXPECT_THROW(scene.multi_hit(rays), Stop);
  EXPECT_THROW(scene.count_hits(rays), Stop);
  EXPECT_TRUE(scene.any_hit(ray_at(0.25f, 0)));
  squares.adds_too_many = true;
  scene.replace(0, kiwami::UserGeometry(device, 40, squares));
  scene.commit();
  EXPECT_THROW(scene.any_hit(ray_at(0.25f, 0)), std::length_error);
  EXPECT_THROW(kiwami::UserGeometry(device, std::uint64_t{1} << 40, squares), kiwami::Error);
}

TEST(Callbacks, EachOfManyCallsThrowsItsOwn) {
  const kiwami::Device device;
  Squares squares(nullptr);
  squares.throws_at = 0.5f;
  kiwami::Scene scene(device);
  scene.attach(kiwami::UserGeometry(device, 40, squares));
  scene.commit();
  std::array<std::atomic<int>, 4> stopped{};
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < stopped.size(); ++i) {
      threads.emplace_back([&, i] {
        for (int round = 0; round < 200; ++round) {
          try {
            scene.closest_hit(ray_at(i % 2 == 0 ? 0.5f : 0.25f, 0));
          } catch (const Stop&) {
            ++stopped[i];
          }
        }
      });
    }
  }
  for (std::size_t i = 0; i < stopped.size(); ++i) EXPECT_EQ(stopped[i], i % 2 == 0 ? 200 : 0);
}

TEST(Callbacks, CallsThatFailForAnotherReasonSaySo) {
  const kiwami::Device device;
  Squares squares(nullptr);
  squares.throws_at = 0.5f;
  kiwami::Scene throwing(device);
  throwing.attach(kiwami::UserGeometry(device, 40, squares));
  throwing.commit();
  std::atomic<bool> is_over{false};
  std::atomic<int> thrown{0};
  std::jthread other([&] {
    for (; !is_over; ++thrown) EXPECT_THROW(throwing.any_hit(ray_at(0.5f, 0)), Stop);
  });
  while (thrown == 0) std::this_thread::yield();
  kiwami::Scene scene = layers(device);
  const auto fail = [](const kiwami::FilterCandidate&) -> bool { throw std::string("own"); };
  for (int round = 0; round < 2000; ++round) {
    EXPECT_THROW(scene.any_hit(ray_at(0, 0), fail), std::string);
    EXPECT_THROW(scene.commit([](double) { return true; }), kiwami::Error);
  }
  is_over = true;
}

}  // namespace
