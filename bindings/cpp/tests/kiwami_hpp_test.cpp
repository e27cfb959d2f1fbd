// SPDX-License-Identifier: Apache-2.0
// The habits of the C++ layer.
#include <thread>
#include <type_traits>

#include "support.h"

namespace {

TEST(KiwamiHpp, HandlesOwnWhatTheyName) {
  static_assert(std::is_nothrow_move_constructible_v<kiwami::Scene>);
  kiwami::Scene scene = [&] {
    const kiwami::Device device;
    kiwami::Scene made(device);
    const kiwami::Mesh mesh(device, kCorners, std::span(&kTriangle, 1));
    EXPECT_EQ(made.attach(mesh), 0u);
    made.commit();
    return made;
  }();
  kiwami::Scene copy = scene;
  EXPECT_EQ(copy.get(), scene.get());
  kiwami::Scene moved = std::move(scene);
  EXPECT_FALSE(scene);
  EXPECT_EQ(moved.closest_hit(ray_at(0.25f, 0.25f)).t, 1.0f);
  moved = copy;
  EXPECT_TRUE(moved.any_hit(ray_at(0.25f, 0.25f)));
  EXPECT_FALSE(moved.any_hit(ray_at(2, 2)));
  EXPECT_EQ(moved.info().triangle_count, 1u);
}

TEST(KiwamiHpp, SpansOfDifferentSizesAreAnError) {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  scene.attach(kiwami::Mesh(device, {}, {}));
  scene.commit();
  std::array<kiwami::Ray, 2> rays{ray_at(0, 0), ray_at(1, 1)};
  std::array<kiwami::Hit, 1> hits;
  EXPECT_THROW(scene.closest_hit(rays, hits), kiwami::Error);
  EXPECT_TRUE(scene.closest_hit(std::span<const kiwami::Ray>{}).empty());
  EXPECT_TRUE(scene.multi_hit(std::span<const kiwami::Ray>{}).hits.empty());
}

TEST(KiwamiHpp, ManyThreadsTraceOneScene) {
  const kiwami::Device device;
  kiwami::Scene scene(device);
  scene.attach(kiwami::Mesh(device, kCorners, std::span(&kTriangle, 1)));
  scene.commit();
  std::vector<kiwami::Ray> rays;
  for (int i = 0; i < 100; ++i) rays.push_back(ray_at(static_cast<float>(i) / 50, 0.1f));
  const std::vector<kiwami::Hit> expected = scene.closest_hit(rays);
  std::array<std::vector<kiwami::Hit>, 4> found;
  std::vector<std::jthread> threads;
  for (auto& hits : found) threads.emplace_back([&] { hits = scene.closest_hit(rays); });
  threads.clear();
  for (const auto& hits : found) {
    ASSERT_EQ(hits.size(), expected.size());
    for (std::size_t i = 0; i < hits.size(); ++i) {
      EXPECT_EQ(std::bit_cast<Bits>(hits[i]), std::bit_cast<Bits>(expected[i]));
    }
  }
}

TEST(KiwamiHpp, ArraysOfDifferentSizesAreAnError) {
  const kiwami::Device device;
  const std::array<kiwami::Sphere, 2> points{};
  const std::array<kiwami::Scene, 1> scenes{scene_of_one_triangle(device)};
  const std::array<kiwami::Transform, 1> transforms{{{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}};
  const std::array<std::uint32_t, 2> numbers{};
  EXPECT_THROW(kiwami::Discs(device, points, kCorners), kiwami::Error);
  EXPECT_THROW(kiwami::MovingMesh(device, kCorners, 2, {}), kiwami::Error);
  EXPECT_THROW(kiwami::Instances(device, scenes, transforms, numbers), kiwami::Error);
  EXPECT_THROW(kiwami::Instances(device, scenes, transforms, {}, numbers), kiwami::Error);
  EXPECT_THROW(kiwami::Instances(device, {}, transforms), kiwami::Error);
  kiwami::Mesh mesh(device, kCorners, std::span(&kTriangle, 1));
  EXPECT_THROW(mesh.update_vertices(std::span(kCorners).first(2)), kiwami::Error);
}

TEST(KiwamiHpp, GeometriesAreReplaced) {
  const kiwami::Device device;
  kiwami::Scene scene = scene_of_one_triangle(device);
  const std::array<kiwami::Sphere, 1> ball{{{0, 0, 5, 1}}};
  scene.replace(0, kiwami::Spheres(device, ball));
  scene.commit();
  EXPECT_EQ(scene.closest_hit(ray_at(0, 0)).t, 5.0f);
}

}  // namespace
