// SPDX-License-Identifier: Apache-2.0
// Scenes of instances that move in files: what was committed, also far out, and what is forged.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>

#include "api/io_support.h"

namespace kiwami_api_tests {
namespace {

using namespace kiwami_tests;

constexpr uint32_t kTrees = 2, kGeometries = 3, kBuffers = 4, kTreeRecords = 5, kRecords = 14,
                   kStarts = 16, kMeshBoxes = 17, kMovingRecord = 24, kSteps = 25, kBoxes = 26,
                   kArrays = 27;

using Matrix = std::array<float, 12>;

Matrix moved_by(float x, float scale = 0.5f) {
  return {scale, 0, 0, x, 0, scale, 0, 0, 0, 0, scale, 0};
}

/// Arrays of a scene of a few triangles, as a program makes them.
class MovingInstanceFile : public testing::Test {
 protected:
  kiwami_moving_instances_desc desc_of(const void* transforms, uint32_t steps, uint64_t count) {
    kiwami_moving_instances_desc desc;
    EXPECT_EQ(kiwami_moving_instances_desc_init(&desc, sizeof desc), KIWAMI_OK);
    desc.scenes = &shown_;
    desc.scene_count = 1;
    desc.transforms = transforms;
    desc.step_count = steps;
    desc.count = count;
    return desc;
  }

  Geometry make(const kiwami_moving_instances_desc& desc) {
    kiwami_geometry* geometry = nullptr;
    EXPECT_EQ(kiwami_moving_instances_create(device_.get(), &desc, &geometry), KIWAMI_OK)
        << last_error();
    return Geometry(geometry);
  }

  /// An instance that rests, number 0, then one that moves, number 1.
  Scene make_both(uint32_t format, uint32_t rebraiding) {
    const Matrix at_rest = moved_by(0.5f), steps[] = {moved_by(-1.0f), moved_by(1.0f)};
    kiwami_quaternion_transform turns[2] = {};
    for (int i = 0; i < 2; ++i) {
      turns[i].scale_x = turns[i].scale_y = turns[i].scale_z = 0.5f;
      (i == 0 ? turns[i].quaternion_r : turns[i].quaternion_k) = 1.0f;
    }
    kiwami_instances_desc resting;
    EXPECT_EQ(kiwami_instances_desc_init(&resting, sizeof resting), KIWAMI_OK);
    resting.scenes = &shown_;
    resting.scene_count = resting.count = 1;
    resting.transforms = at_rest.data();
    kiwami_geometry* geometry = nullptr;
    EXPECT_EQ(kiwami_instances_create(device_.get(), &resting, &geometry), KIWAMI_OK);
    const Geometry first(geometry);
    const bool is_matrix = format == KIWAMI_TRANSFORM_MATRIX;
    kiwami_moving_instances_desc moving =
        desc_of(is_matrix ? static_cast<const void*>(steps) : turns, 2, 1);
    moving.format = format;
    const Geometry second = make(moving);
    Scene scene = make_scene(device_);
    for (const Geometry* each : {&first, &second}) {
      EXPECT_EQ(kiwami_scene_attach(scene.get(), each->get(), nullptr), KIWAMI_OK);
    }
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_REBRAID, rebraiding),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  }

  void expect_comes_back(const Scene& scene, const std::vector<kiwami_ray>& rays,
                         bool is_met = true) {
    Scene loaded;
    const Bytes file = saved(scene);
    ASSERT_EQ(load(device_, file, 0, loaded), KIWAMI_OK) << last_error();
    EXPECT_EQ(saved(loaded), file);
    EXPECT_EQ(kiwami_scene_validate(loaded.get()), KIWAMI_OK) << last_error();
    std::vector<kiwami_hit> before(rays.size()), after(rays.size());
    ASSERT_EQ(
        kiwami_closest_hit(scene.get(), rays.data(), 0, before.data(), 0, rays.size(), nullptr),
        KIWAMI_OK);
    ASSERT_EQ(
        kiwami_closest_hit(loaded.get(), rays.data(), 0, after.data(), 0, rays.size(), nullptr),
        KIWAMI_OK);
    EXPECT_TRUE(are_equal(before, after));
    EXPECT_TRUE(!is_met || std::any_of(before.begin(), before.end(), [](const kiwami_hit& hit) {
      return hit.primitive_id != KIWAMI_INVALID_ID;
    }));
  }

  static ForgedSection section_of(const Bytes& file, uint32_t type) {
    for (const ForgedSection& section : sections_of(file)) {
      if (section.type == type) return section;
    }
    ADD_FAILURE() << "no section of type " << type;
    return {};
  }

  /// Of a scene whose segment of time was halved: the boxes come back, and no other number of them.
  void expect_halved(const Scene& scene, uint32_t type, size_t tree) {
    std::vector<kiwami_ray> rays = random_rays(1000, 11);
    for (kiwami_ray& ray : rays) ray.origin_x *= 16.0f, ray.direction_x *= 16.0f;
    expect_comes_back(scene, rays);
    const Bytes file = saved(scene);
    uint32_t width;
    uint64_t node_count;
    const uint64_t record = section_of(file, kTreeRecords).offset + 128 * tree;
    std::memcpy(&width, &file[record + 4], sizeof width);
    std::memcpy(&node_count, &file[record + 24], sizeof node_count);
    const uint64_t undivided = node_count * width * 48, bytes = section_of(file, type).bytes;
    ASSERT_EQ(bytes, 2 * undivided);
    for (const uint64_t wrong : {uint64_t{0}, undivided - 64, undivided + 64, bytes - 64}) {
      expect_refused_size(file, type, wrong, "bytes, expected");
    }
  }

  void expect_refused_size(Bytes file, uint32_t type, uint64_t bytes, const char* sentence) {
    const std::vector<ForgedSection> sections = sections_of(file);
    for (size_t i = 0; i < sections.size(); ++i) {
      if (sections[i].type == type) std::memcpy(&file[64 + 48 * i + 24], &bytes, sizeof bytes);
    }
    forge_checksums(file);
    Scene scene;
    EXPECT_EQ(load(device_, file, 0, scene), KIWAMI_ERROR_INVALID_FILE) << bytes;
    EXPECT_NE(last_error().find(sentence), std::string::npos) << last_error();
  }

  template <typename T>
  void expect_refused(Bytes file, uint32_t type, uint64_t at, const T& value,
                      const char* sentence) {
    const ForgedSection section = section_of(file, type);
    ASSERT_LE(at + sizeof value, section.bytes);
    std::memcpy(file.data() + section.offset + at, &value, sizeof value);
    forge_checksums(file);
    Scene scene;
    EXPECT_EQ(load(device_, file, 0, scene), KIWAMI_ERROR_INVALID_FILE);
    EXPECT_NE(last_error().find(sentence), std::string::npos) << last_error();
  }

  Device device_ = make_device();
  Scene child_ = make_scene(device_, make_mesh(device_, random_triangles(30, 1).desc()));
  kiwami_scene* shown_ = child_.get();
};

/// Buffers with gaps that are shared: the steps are those that were committed, whatever has become
/// of them.
TEST_F(MovingInstanceFile, HoldsWhatWasCommitted) {
  constexpr uint32_t kCount = 3, kStepCount = 4;
  constexpr size_t kStepStride = 56, kStride = kStepCount * kStepStride + 20;
  std::vector<unsigned char> transforms(kCount * kStride);
  const auto fill = [&](float offset) {
    for (uint32_t i = 0; i < kCount * kStepCount; ++i) {
      const Matrix matrix = moved_by(offset + 0.2f * static_cast<float>(i % 5) - 0.4f);
      std::memcpy(&transforms[i / kStepCount * kStride + i % kStepCount * kStepStride],
                  matrix.data(), 48);
    }
  };
  fill(0.0f);
  kiwami_moving_instances_desc desc = desc_of(transforms.data(), kStepCount, kCount);
  desc.flags = KIWAMI_INSTANCES_SHARE_BUFFERS;
  desc.transform_stride = kStride;
  desc.step_stride = kStepStride;
  const Geometry geometry = make(desc);
  const Scene scene = make_scene(device_, geometry);
  expect_comes_back(scene, random_rays(300, 3));
  fill(0.75f);
  const Bytes file = saved(scene);
  Scene loaded;
  ASSERT_EQ(load(device_, file, 0, loaded), KIWAMI_OK) << last_error();
  const std::vector<kiwami_ray> rays = random_rays(300, 3);
  std::vector<kiwami_hit> before(rays.size()), after(rays.size());
  const auto trace = [&](const Scene& of, std::vector<kiwami_hit>& hits) {
    ASSERT_EQ(kiwami_closest_hit(of.get(), rays.data(), 0, hits.data(), 0, rays.size(), nullptr),
              KIWAMI_OK);
  };
  trace(scene, before);
  trace(loaded, after);
  EXPECT_TRUE(are_equal(before, after));
  // The buffers come along as they are now: both commit the same.
  for (const Scene* either : {&scene, static_cast<const Scene*>(&loaded)}) {
    ASSERT_EQ(kiwami_scene_commit(either->get()), KIWAMI_OK) << last_error();
  }
  std::vector<kiwami_hit> committed(rays.size());
  trace(scene, committed);
  trace(loaded, after);
  EXPECT_TRUE(are_equal(committed, after));
  EXPECT_FALSE(are_equal(committed, before));
}

/// As far out as coordinates go, and beyond, where nothing is promised to be hit.
TEST_F(MovingInstanceFile, ComesBackFromFarOut) {
  for (const float place : {1e6f, 1e12f, 4e17f, 1e18f, 1e30f}) {
    SCOPED_TRACE(place);
    const float scale = std::min(place, 1e18f);
    const std::vector<Matrix> steps = {moved_by(-place, 0.1f * scale),
                                       moved_by(place, 0.2f * scale), moved_by(0.0f, 0.3f * scale)};
    const Scene scene = make_scene(device_, make(desc_of(steps.data(), 3, 1)));
    std::vector<kiwami_ray> rays = random_rays(300, 5);
    for (kiwami_ray& ray : rays) {
      ray.origin_x *= scale, ray.origin_y *= scale, ray.origin_z *= scale;
      ray.tmin = 0.0f;
      ray.tmax = kInfinity;
    }
    expect_comes_back(scene, rays, scale < 1e18f);
  }
}

/// What changes sides has boxes at the middle of its way, too.
TEST_F(MovingInstanceFile, HoldsTheBoxesOfDividedTimes) {
  std::vector<float> vertices;
  std::vector<Matrix> steps;
  for (const float side : {1.0f, -1.0f}) {
    for (int i = 0; i < 256; ++i) {
      const float x = side * (static_cast<float>(i) - 127.5f) / 8.0f;
      const float y = static_cast<float>(i % 32) / 16.0f - 1.0f;
      vertices.insert(vertices.end(), {x, y, 0, x + 0.1f, y, 0, x, y + 0.1f, 0.1f});
    }
  }
  for (int i = 0; i < 256; ++i) {
    const float x = (static_cast<float>(i) - 127.5f) / 8.0f;
    steps.insert(steps.end(), {moved_by(x, 0.05f), moved_by(-x, 0.05f)});
  }
  kiwami_moving_mesh_desc mesh;
  ASSERT_EQ(kiwami_moving_mesh_desc_init(&mesh, sizeof mesh), KIWAMI_OK);
  mesh.vertices = vertices.data();
  mesh.vertex_count = size_t{3} * 256;
  mesh.triangle_count = 256;
  kiwami_geometry* geometry = nullptr;
  ASSERT_EQ(kiwami_moving_mesh_create(device_.get(), &mesh, &geometry), KIWAMI_OK) << last_error();
  expect_halved(make_scene(device_, Geometry(geometry)), kMeshBoxes, 1);
  expect_halved(make_scene(device_, make(desc_of(steps.data(), 2, 256))), kBoxes, 2);
}

/// Rays do not look whether an instance of a regular array is singular: nobody may call others so.
TEST_F(MovingInstanceFile, HoldsWhichArraysAreRegular) {
  const Matrix steps[] = {moved_by(0.5f, 0.5f), moved_by(-0.5f, 0.5f), moved_by(0.5f, 0.5f),
                          moved_by(-0.5f, -0.5f)};
  const Geometry both = make(desc_of(steps, 2, 2)), first = make(desc_of(steps, 2, 1));
  const Scene scene = make_scene(device_);
  for (const Geometry* each : {&both, &first}) {
    EXPECT_EQ(kiwami_scene_attach(scene.get(), each->get(), nullptr), KIWAMI_OK);
  }
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
  expect_comes_back(scene, random_rays(3000, 7));
  const Bytes file = saved(scene);
  const ForgedSection section = section_of(file, kArrays);
  ASSERT_EQ(section.bytes, 8u);
  uint32_t regular[2];
  std::memcpy(regular, &file[section.offset], sizeof regular);
  EXPECT_EQ(regular[0], 0u);
  EXPECT_EQ(regular[1], 1u);
  expect_refused(file, kArrays, 0, uint32_t{1}, "instance 1 of an array that moves is near");
  expect_refused_size(file, kArrays, 4, "the steps of 1 arrays of instances");
}

/// Leaves of each tree name its own instances alone: those of the other one are elsewhere.
TEST_F(MovingInstanceFile, OfInstancesInTheWrongTreeIsRefused) {
  const Bytes file = saved(make_both(KIWAMI_TRANSFORM_MATRIX, KIWAMI_REBRAID_OFF));
  const uint32_t resting = 0, moving = 1, none = 2;
  // Trees of one leaf block each, at multiples of 64.
  ASSERT_EQ(section_of(file, kTreeRecords).bytes, 3u * 128);
  for (const uint32_t number : {moving, none}) {
    expect_refused(file, kTrees, 0, number, "expected one of what the tree is over");
  }
  for (const uint32_t number : {resting, none}) {
    expect_refused(file, kTrees, 64, number, "expected one of what the tree is over");
  }
  const Bytes rebraided = saved(make_both(KIWAMI_TRANSFORM_MATRIX, KIWAMI_REBRAID_FULL));
  expect_refused(rebraided, kStarts, 0, moving, "start 0 is of instance 1");
}

/// An instance that rests is looked at as it was committed, and as a new commit would find it.
TEST_F(MovingInstanceFile, OfRestingInstancesThatCannotBeEnteredIsRefused) {
  const Bytes file = saved(make_both(KIWAMI_TRANSFORM_MATRIX, KIWAMI_REBRAID_OFF));
  const char* const sentence = "instance 0 shows scene 0 of 2 by a transform that is singular";
  for (const uint32_t type : {kBuffers, kRecords}) {
    expect_refused(file, type, 0, std::nanf(""), sentence);
    expect_refused(file, type, 0, Matrix{}, sentence);
  }
  // Buffers that are shared may have changed since the commit: both may be right.
  const Matrix other = {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0};
  for (const uint32_t type : {kBuffers, kRecords}) {
    Bytes changed = file;
    std::memcpy(&changed[section_of(file, type).offset], other.data(), sizeof other);
    if (type == kBuffers) {
      std::memcpy(&changed[section_of(file, type).offset], moved_by(3.0f).data(), sizeof other);
    }
    forge_checksums(changed);
    Scene loaded;
    EXPECT_EQ(load(device_, changed, 0, loaded), KIWAMI_OK) << last_error();
    EXPECT_EQ(kiwami_scene_commit(loaded.get()), KIWAMI_OK) << last_error();
  }
  // What is built anew goes by the array alone.
  Bytes changed = file;
  std::memset(&changed[section_of(file, kBuffers).offset], 0, sizeof(Matrix));
  forge_checksums(changed);
  kiwami_load_desc desc = default_load();
  desc.data = changed.data();
  desc.size = changed.size();
  desc.bvh_width = info_of(make_both(KIWAMI_TRANSFORM_MATRIX, 0)).bvh_width == 4 ? 8 : 4;
  Scene loaded;
  EXPECT_EQ(load(device_, desc, loaded), KIWAMI_ERROR_INVALID_FILE);
  EXPECT_NE(last_error().find("the transform of instance 0 is singular"), std::string::npos)
      << last_error();
}

TEST_F(MovingInstanceFile, OfNumbersThatNoMotionHasIsRefused) {
  const float nan = std::nanf("");
  for (const uint32_t format : {KIWAMI_TRANSFORM_MATRIX, KIWAMI_TRANSFORM_QUATERNION}) {
    const Bytes file = saved(make_both(format, KIWAMI_REBRAID_OFF));
    for (const uint64_t at : {0, 16}) {
      expect_refused(file, kSteps, at, nan, "step 0 of an array of instances is singular");
    }
    expect_refused(file, kSteps, 0, std::array<float, 8>{},
                   "step 0 of an array of instances is singular");
    expect_refused(file, kMovingRecord, 0, -kInfinity, "the instances reach from");
    expect_refused(file, kMovingRecord, 24, -1.0f, "the errors of instances are");
    // Of the second geometry: the number of steps, the time, the kind.
    expect_refused(file, kGeometries, 64 + 28, uint32_t{1}, "has 1 time steps");
    expect_refused(file, kGeometries, 64 + 28, uint32_t{3}, "expected");
    expect_refused(file, kGeometries, 64 + 32, 2.0f, "expected finite times");
    expect_refused(file, kGeometries, 64 + 36, nan, "expected finite times");
    expect_refused(file, kGeometries, 64, uint32_t{8}, "is of kind 8");
    const uint32_t flags = 1 | 2 | (format == KIWAMI_TRANSFORM_MATRIX ? 64u : 0u);
    expect_refused(file, kGeometries, 64 + 4, flags, "expected");
    // It shows the second of one scene.
    expect_refused(file, kRecords, 52 + 48, uint32_t{2}, "instance 1 shows scene 2 of 2");
  }
  const Bytes turning = saved(make_both(KIWAMI_TRANSFORM_QUATERNION, KIWAMI_REBRAID_OFF));
  for (const float angle : {-1.0f, 3.0f, nan}) {
    expect_refused(turning, kSteps, 64, angle, "step 0 of an array of instances is singular");
  }
  const std::vector<Matrix> steps(10, moved_by(0.0f));
  const Bytes several = saved(make_scene(device_, make(desc_of(steps.data(), 2, 5))));
  expect_refused(several, kBoxes, 0, nan, "number 0 of the moving boxes is nan");
}

}  // namespace
}  // namespace kiwami_api_tests
