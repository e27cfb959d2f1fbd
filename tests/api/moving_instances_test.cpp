// SPDX-License-Identifier: Apache-2.0
// Instances that move, through the C interface: where they are at a time, what is said of it, and
// what is refused.
#include <cmath>
#include <cstring>

#include "api/instances_support.h"

namespace kiwami_api_tests {
namespace {

constexpr float kPi = 3.14159265f;

/// Turned about the z axis by an angle in half turns, and moved.
kiwami_quaternion_transform turn(float half_turns, float x = 0, float y = 0) {
  kiwami_quaternion_transform made{};
  made.scale_x = made.scale_y = made.scale_z = 1.0f;
  made.quaternion_r = std::cos(0.5f * kPi * half_turns);
  made.quaternion_k = std::sin(0.5f * kPi * half_turns);
  made.translation_x = x;
  made.translation_y = y;
  return made;
}

class MovingInstances : public Instances {
 protected:
  kiwami_moving_instances_desc desc_of(const void* transforms, uint32_t steps,
                                       uint64_t count = 1) const {
    kiwami_moving_instances_desc desc;
    EXPECT_EQ(kiwami_moving_instances_desc_init(&desc, sizeof desc), KIWAMI_OK);
    desc.scenes = &shown_;
    desc.scene_count = 1;
    desc.transforms = transforms;
    desc.step_count = steps;
    desc.count = count;
    return desc;
  }
  kiwami_moving_instances_desc desc_of(const std::vector<Matrix>& steps) const {
    return desc_of(steps.data(), static_cast<uint32_t>(steps.size()));
  }
  kiwami_moving_instances_desc desc_of(
      const std::vector<kiwami_quaternion_transform>& steps) const {
    kiwami_moving_instances_desc desc = desc_of(steps.data(), static_cast<uint32_t>(steps.size()));
    desc.format = KIWAMI_TRANSFORM_QUATERNION;
    return desc;
  }

  Geometry make_moving(const kiwami_moving_instances_desc& desc) const {
    kiwami_geometry* geometry = nullptr;
    EXPECT_EQ(kiwami_moving_instances_create(device_.get(), &desc, &geometry), KIWAMI_OK)
        << last_error();
    return Geometry(geometry);
  }
  Scene scene_of_moving(const kiwami_moving_instances_desc& desc) const {
    Scene scene = make_scene(device_, make_moving(desc));
    EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
    return scene;
  }

  void expect_moving_refused(const kiwami_moving_instances_desc& desc,
                             const std::string& sentence) const {
    kiwami_geometry* geometry = reinterpret_cast<kiwami_geometry*>(device_.get());
    EXPECT_EQ(kiwami_moving_instances_create(device_.get(), &desc, &geometry),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(geometry, nullptr);
    EXPECT_EQ(last_error(device_.get()), sentence);
  }

  static Matrix transform_at(const Geometry& instances, uint64_t instance, float time) {
    Matrix matrix{};
    EXPECT_EQ(kiwami_instances_transform(instances.get(), instance, time, matrix.data()), KIWAMI_OK)
        << last_error();
    return matrix;
  }

  kiwami_scene* shown_ = child_.get();
};

kiwami_ray at_time(kiwami_ray ray, float time) {
  ray.time = time;
  return ray;
}

TEST_F(MovingInstances, AreWhereTheTimeSays) {
  const std::vector<Matrix> steps = {translation(0, 0, 0), translation(0, 0, 4),
                                     translation(0, 0, 6)};
  const Scene scene = scene_of_moving(desc_of(steps));
  const auto t_at = [&](float time) {
    return trace(scene, at_time(ray_at(0.5f, 0.25f), time)).hit.t;
  };
  EXPECT_EQ(t_at(0.0f), 10.0f);
  EXPECT_EQ(t_at(0.25f), 12.0f);
  EXPECT_EQ(t_at(0.5f), 14.0f);
  EXPECT_EQ(t_at(0.75f), 15.0f);
  EXPECT_EQ(t_at(1.0f), 16.0f);
  for (const float time : {-0.01f, 1.01f, std::nanf(""), kInfinity}) {
    EXPECT_EQ(t_at(time), kInfinity) << time;
  }
  const kiwami_scene_info info = info_of(scene);
  EXPECT_EQ(info.instance_count, 1u);
  EXPECT_EQ(info.instance_depth, 1u);
  EXPECT_GT(info.instance_tree_bytes, 0u);
  EXPECT_LE(info.bounds_min[2], 0.0f);
  EXPECT_GE(info.bounds_max[2], 6.0f);
  EXPECT_NEAR(info.bounds_max[2], 6.0f, 1e-4f);
}

TEST_F(MovingInstances, HaveARangeOfTimeOfTheirOwn) {
  const std::vector<Matrix> steps = {translation(0, 0, 0), translation(0, 0, 8)};
  kiwami_moving_instances_desc desc = desc_of(steps);
  desc.time_begin = 2.0f;
  desc.time_end = 4.0f;
  const Scene scene = scene_of_moving(desc);
  EXPECT_EQ(trace(scene, at_time(ray_at(0.5f, 0.25f), 2.5f)).hit.t, 12.0f);
  EXPECT_EQ(trace(scene, at_time(ray_at(0.5f, 0.25f), 1.0f)).hit.t, kInfinity);
}

/// At a quarter turn the corners of the square are beyond its sides.
TEST_F(MovingInstances, TurnEvenlyAlongTheShorterArc) {
  const std::vector<kiwami_quaternion_transform> steps = {turn(0.0f), turn(0.5f, 3.0f)};
  const Scene scene = scene_of_moving(desc_of(steps));
  const Geometry instances = make_moving(desc_of(steps));
  for (const float time : {0.0f, 0.1f, 0.25f, 0.5f, 0.7f, 1.0f}) {
    const Matrix matrix = transform_at(instances, 0, time);
    const float angle = 0.5f * kPi * time;
    EXPECT_NEAR(matrix[0], std::cos(angle), 3e-7f) << time;
    EXPECT_NEAR(matrix[4], std::sin(angle), 3e-7f) << time;
    EXPECT_NEAR(matrix[3], 3.0f * time, 3e-7f);
    EXPECT_EQ(matrix[10], 1.0f);
    // A ray through a corner, which goes along an arc, and one just beyond.
    const auto met_at = [&](float part) {
      const float x = std::cos(angle) - std::sin(angle), y = std::sin(angle) + std::cos(angle);
      const kiwami_ray ray = ray_at(part * x + 3.0f * time, part * y);
      return trace(scene, at_time(ray, time)).hit.instance_id;
    };
    EXPECT_EQ(met_at(0.99f), 0u) << time;
    EXPECT_EQ(met_at(1.01f), KIWAMI_INVALID_ID) << time;
  }
  // The same rotation by the negative of its quaternion, of another length.
  kiwami_quaternion_transform other = steps[1];
  for (float* entry : {&other.quaternion_r, &other.quaternion_k}) *entry *= -3.0f;
  const Geometry same = make_moving(desc_of({steps[0], other}));
  for (size_t i = 0; i < 12; ++i) {
    EXPECT_NEAR(transform_at(same, 0, 0.3f)[i], transform_at(instances, 0, 0.3f)[i], 3e-7f);
  }
}

TEST_F(MovingInstances, ScaleSkewAndShiftGoBeforeTheRotation) {
  kiwami_quaternion_transform step = turn(0.5f, 10.0f, 20.0f);
  step.scale_x = 2.0f;
  step.scale_y = 3.0f;
  step.scale_z = 4.0f;
  step.skew_xy = 0.5f;
  step.skew_xz = 0.25f;
  step.skew_yz = 0.125f;
  step.shift_x = 1.0f;
  step.shift_y = 2.0f;
  step.shift_z = 3.0f;
  const Geometry instances = make_moving(desc_of({step, step}));
  // The rotation takes x to y and y to -x.
  const Matrix expected = {0, -3, -0.125f, 8, 2, 0.5f, 0.25f, 21, 0, 0, 4, 3};
  const Matrix matrix = transform_at(instances, 0, 0.5f);
  for (size_t i = 0; i < 12; ++i) EXPECT_NEAR(matrix[i], expected[i], 2e-6f) << i;
}

/// Halfway between two opposite turns a matrix is flat: there nothing is met, elsewhere all.
TEST_F(MovingInstances, AreNotThereWhileSingular) {
  const std::vector<Matrix> steps = {scaling(1, 1, 1), scaling(-1, 1, 1)};
  const Scene scene = scene_of_moving(desc_of(steps));
  const auto is_met = [&](float x, float time) {
    return trace(scene, at_time(ray_at(x, 0.25f), time)).hit.instance_id == 0;
  };
  EXPECT_FALSE(is_met(0.0f, 0.5f));
  EXPECT_TRUE(is_met(0.19f, 0.4f));
  EXPECT_FALSE(is_met(0.21f, 0.4f));
  EXPECT_TRUE(is_met(0.0f, 0.50001f));
  EXPECT_TRUE(is_met(-0.9f, 0.0f));
}

TEST_F(MovingInstances, AreNumberedThroughWithThoseThatRest) {
  const Scene scene = make_scene(device_);
  const Geometry resting =
      make({{child_.get()}, {}, {translation(0, 0, 0), translation(10, 0, 0)}, {}});
  const std::vector<Matrix> steps = {translation(20, 0, 0), translation(20, 0, 4),
                                     translation(30, 0, 0), translation(30, 0, 4)};
  const Geometry moving = make_moving(desc_of(steps.data(), 2, 2));
  const Geometry last = make({{child_.get()}, {}, {translation(40, 0, 0)}, {}});
  for (const Geometry* geometry : {&resting, &moving, &last}) {
    ASSERT_EQ(kiwami_scene_attach(scene.get(), geometry->get(), nullptr), KIWAMI_OK);
  }
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  const auto number_at = [&](float x) {
    return trace(scene, at_time(ray_at(x + 0.5f, 0.25f), 0.5f)).hit.instance_id;
  };
  for (uint32_t i = 0; i < 5; ++i) EXPECT_EQ(number_at(10.0f * static_cast<float>(i)), i);
  ASSERT_EQ(kiwami_scene_enable(scene.get(), 0, 0), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(number_at(20.0f), 0u);
  EXPECT_EQ(number_at(40.0f), 2u);
  EXPECT_EQ(number_at(0.0f), KIWAMI_INVALID_ID);
}

TEST_F(MovingInstances, AreEnteredByMasks) {
  const std::vector<Matrix> steps = {translation(0, 0, 1), translation(0, 0, 1),
                                     translation(0, 0, 2), translation(0, 0, 2)};
  const uint32_t masks[] = {1, 6};
  kiwami_moving_instances_desc desc = desc_of(steps.data(), 2, 2);
  desc.masks = masks;
  desc.mask = 5;
  const Scene scene = scene_of_moving(desc);
  const auto number_for = [&](uint32_t mask) {
    kiwami_ray ray = ray_at(0.5f, 0.25f);
    ray.mask = mask;
    return trace(scene, ray).hit.instance_id;
  };
  EXPECT_EQ(number_for(1), 0u);
  EXPECT_EQ(number_for(2), KIWAMI_INVALID_ID);
  EXPECT_EQ(number_for(4), 1u);
}

TEST_F(MovingInstances, StandInOthersThatMove) {
  const std::vector<Matrix> inner_steps = {translation(0, 0, 0), translation(0, 0, 8)};
  const Scene inner = scene_of_moving(desc_of(inner_steps));
  shown_ = inner.get();
  const std::vector<Matrix> outer_steps = {translation(0, 0, 0), translation(4, 0, 0)};
  const Scene scene = scene_of_moving(desc_of(outer_steps));
  const PathHit answer = trace(scene, at_time(ray_at(2.5f, 0.25f), 0.5f));
  EXPECT_EQ(answer.hit.t, 14.0f);
  EXPECT_EQ(answer.path[0], 0u);
  EXPECT_EQ(answer.path[1], 0u);
  EXPECT_EQ(answer.path[2], KIWAMI_INVALID_ID);
  // Re-braiding leaves the boxes of what moves alone.
  const Geometry resting = make({{scene.get()}, {}, {translation(0, 0, 1)}, {}});
  const Scene outermost = make_scene(device_);
  kiwami_scene_set_parameter(outermost.get(), KIWAMI_PARAMETER_REBRAID, KIWAMI_REBRAID_FULL);
  kiwami_scene_set_parameter(outermost.get(), KIWAMI_PARAMETER_REBRAID_BUDGET, 20);
  ASSERT_EQ(kiwami_scene_attach(outermost.get(), resting.get(), nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(outermost.get()), KIWAMI_OK);
  EXPECT_EQ(trace(outermost, at_time(ray_at(2.5f, 0.25f), 0.5f)).hit.t, 15.0f);
}

TEST_F(MovingInstances, OfNothingAreNeverHit) {
  const Scene empty = make_scene(device_);
  ASSERT_EQ(kiwami_scene_commit(empty.get()), KIWAMI_OK);
  shown_ = empty.get();
  const std::vector<Matrix> steps = {kIdentity, kIdentity};
  const Scene scene = scene_of_moving(desc_of(steps));
  EXPECT_EQ(trace(scene, ray_at(0, 0)).hit.primitive_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(info_of(scene).bounds_min[0], kInfinity);
}

TEST_F(MovingInstances, SharedBuffersAreReadByEachCommit) {
  std::vector<Matrix> steps = {translation(0, 0, 5), translation(0, 0, 7)};
  kiwami_moving_instances_desc desc = desc_of(steps);
  desc.flags = KIWAMI_INSTANCES_SHARE_BUFFERS;
  const Geometry geometry = make_moving(desc);
  const Scene scene = make_scene(device_, geometry);
  const kiwami_ray ray = at_time(ray_at(0.5f, 0.25f), 1.0f);
  EXPECT_EQ(trace(scene, ray).hit.t, 17.0f);
  steps[1] = translation(0, 0, 9);
  EXPECT_EQ(trace(scene, ray).hit.t, 17.0f);
  ASSERT_EQ(kiwami_scene_refit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(trace(scene, ray).hit.t, 19.0f);
  steps[0] = scaling(1, 0, 1);
  expect_commit_fails(scene, KIWAMI_ERROR_INVALID_ARGUMENT,
                      "the transform of instance 0 is singular or not finite at a step, expected a "
                      "condition number of at most 2^20 and scales from 2^-60 to 2^60");
  EXPECT_EQ(trace(scene, ray).hit.t, 19.0f);
}

TEST_F(MovingInstances, StepsMayLieAnywhere) {
  // All instances of a step, then those of the next, between other bytes at odd addresses.
  std::vector<unsigned char> bytes(1 + 2 * 200 + 3 * 50);
  for (uint32_t i = 0; i < 3; ++i) {
    for (uint32_t step = 0; step < 2; ++step) {
      const Matrix matrix = translation(10.0f * static_cast<float>(i), 0, static_cast<float>(step));
      std::memcpy(bytes.data() + 1 + step * 200 + i * 50, matrix.data(), 48);
    }
  }
  kiwami_moving_instances_desc desc = desc_of(bytes.data() + 1, 2, 3);
  desc.transform_stride = 50;
  desc.step_stride = 200;
  for (const uint32_t flags : {0u, uint32_t{KIWAMI_INSTANCES_SHARE_BUFFERS}}) {
    desc.flags = flags;
    const Scene scene = scene_of_moving(desc);
    for (uint32_t i = 0; i < 3; ++i) {
      const kiwami_ray ray = ray_at(10.0f * static_cast<float>(i) + 0.5f, 0.25f);
      const PathHit answer = trace(scene, at_time(ray, 0.5f));
      EXPECT_EQ(answer.hit.instance_id, i);
      EXPECT_EQ(answer.hit.t, 10.5f);
    }
  }
}

TEST_F(MovingInstances, DescriptionsAreChecked) {
  const std::vector<Matrix> steps(130, kIdentity);
  const auto with = [&](auto change) {
    kiwami_moving_instances_desc desc = desc_of(steps.data(), 2);
    change(desc);
    return desc;
  };
  expect_moving_refused(with([](auto& d) { d.flags = 2; }),
                        "desc.flags is 0x2, expected KIWAMI_INSTANCES_* bits");
  expect_moving_refused(with([](auto& d) { d.reserved = 1; }), "desc.reserved is 1, expected 0");
  expect_moving_refused(with([](auto& d) { d.transforms = nullptr; }),
                        "desc.transforms is NULL, expected the matrices");
  expect_moving_refused(with([](auto& d) { d.count = 0; }), "desc.count is 0, expected at least 1");
  expect_moving_refused(with([](auto& d) { d.format = 2; }),
                        "desc.format is 2, expected a kiwami_transform_format");
  expect_moving_refused(with([](auto& d) { d.step_count = 1; }),
                        "desc.step_count is 1, expected 2 to 129");
  expect_moving_refused(with([](auto& d) { d.step_count = 130; }),
                        "desc.step_count is 130, expected 2 to 129");
  expect_moving_refused(with([](auto& d) { d.time_end = 0.0f; }),
                        "desc.time_begin is 0 and desc.time_end 0, expected finite times, the "
                        "second later");
  expect_moving_refused(with([](auto& d) { d.step_stride = 47; }),
                        "desc.step_stride is 47, expected at least 48, or 0 for 48");
  expect_moving_refused(with([](auto& d) {
                          d.format = KIWAMI_TRANSFORM_QUATERNION;
                          d.transform_stride = 63;
                        }),
                        "desc.transform_stride is 63, expected at least 64, or 0 for 64");
  kiwami_geometry* geometry = nullptr;
  EXPECT_EQ(kiwami_moving_instances_create(device_.get(), nullptr, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  kiwami_moving_instances_desc beyond = with([](auto& d) { d.count = 2; });
  beyond.step_stride = ~uint64_t{0} / 2;
  EXPECT_EQ(kiwami_moving_instances_create(device_.get(), &beyond, &geometry),
            KIWAMI_ERROR_INVALID_ARGUMENT);
  EXPECT_NE(last_error(device_.get()).find("reach beyond the address space"), std::string::npos);
}

TEST_F(MovingInstances, SingularStepsAreNamed) {
  const std::string sentence =
      "the transform of instance 1 is singular or not finite at a step, expected a condition "
      "number of at most 2^20 and scales from 2^-60 to 2^60";
  const std::vector<Matrix> steps = {kIdentity, kIdentity, kIdentity, scaling(1, 0, 1)};
  expect_moving_refused(desc_of(steps.data(), 2, 2), sentence);
  kiwami_quaternion_transform none = turn(0.0f);
  none.quaternion_r = 0.0f;
  const std::vector<kiwami_quaternion_transform> turns = {turn(0.0f), turn(0.5f), turn(0.0f), none};
  kiwami_moving_instances_desc desc = desc_of(turns.data(), 2, 2);
  desc.format = KIWAMI_TRANSFORM_QUATERNION;
  expect_moving_refused(desc, sentence);
}

TEST_F(MovingInstances, TellTheirTransforms) {
  const std::vector<Matrix> steps = {translation(0, 0, 0), translation(1, 2, 4)};
  const Geometry moving = make_moving(desc_of(steps));
  EXPECT_EQ(transform_at(moving, 0, 0.5f), translation(0.5f, 1.0f, 2.0f));
  const Geometry resting = make({{child_.get()}, {}, {kIdentity, scaling(1, 2, 3)}, {}});
  EXPECT_EQ(transform_at(resting, 1, std::nanf("")), scaling(1, 2, 3));
  float matrix[12];
  const auto expect_error = [&](const Geometry& geometry, uint64_t instance, float time, float* out,
                                const std::string& sentence) {
    EXPECT_EQ(kiwami_instances_transform(geometry.get(), instance, time, out),
              KIWAMI_ERROR_INVALID_ARGUMENT);
    EXPECT_EQ(last_error(), sentence);
  };
  expect_error(moving, 1, 0.0f, matrix, "instance is 1, expected less than 1");
  expect_error(moving, 0, 1.5f, matrix, "time is 1.5, expected 0 to 1");
  expect_error(moving, 0, 0.5f, nullptr, "transform is NULL, expected a valid pointer");
  expect_error(mesh_, 0, 0.5f, matrix,
               "instances is a geometry of another kind, expected instances");
  EXPECT_EQ(kiwami_instances_transform(nullptr, 0, 0.0f, matrix), KIWAMI_ERROR_INVALID_ARGUMENT);
}

}  // namespace
}  // namespace kiwami_api_tests
