// SPDX-License-Identifier: Apache-2.0
// What moves against Embree: meshes, and one level of instances. At each of some times, double
// precision decides wherever the two disagree by more than 1e-5 of the distance, by the triangles
// as they are then. Hits on one triangle are within 1e-3 of the distance of each other, also where
// Embree's rotations go by approximated sines.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <limits>

#include "measure/double_judge.h"
#include "scene/scene_file.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/quaternion.h"
#include "support/random.h"
#include "support/ray_generator.h"
#include "support/report.h"

namespace kiwami_tests {
namespace {

using kiwami::tools::Agreement;
using kiwami::tools::SceneFile;
using ToolMesh = kiwami::tools::Mesh;
using GeometryHandle = std::unique_ptr<kiwami_geometry, Release>;

/// A mesh at several times.
struct Morph {
  ToolMesh mesh;
  std::vector<std::vector<float>> steps;

  ToolMesh frozen(float time) const {
    ToolMesh still = mesh;
    const auto n = static_cast<float>(steps.size() - 1);
    const auto step = static_cast<size_t>(std::fmin(std::floor(time * n), n - 1.0f));
    const float f = time * n - static_cast<float>(step);
    for (size_t i = 0; i < still.vertices.size(); ++i) {
      still.vertices[i] = (1.0f - f) * steps[step][i] + f * steps[step + 1][i];
    }
    return still;
  }
};

/// An instance of the mesh of this number, by two steps of one kind.
struct Mover {
  uint32_t mesh;
  std::array<std::array<float, 12>, 2> matrices;
  std::array<kiwami_quaternion_transform, 2> turns;
  bool is_turning;

  std::array<float, 12> frozen(float time) const {
    std::array<float, 12> matrix;
    const std::array<double, 12> exact = matrix_between(turns[0], turns[1], double{time});
    for (size_t i = 0; i < 12; ++i) {
      const double straight =
          (1.0 - double{time}) * double{matrices[0][i]} + double{time} * double{matrices[1][i]};
      matrix[i] = static_cast<float>(is_turning ? exact[i] : straight);
    }
    return matrix;
  }
};

struct MovingWorld {
  std::vector<Morph> morphs;
  std::vector<Mover> movers;  ///< none: the morphs stand in the world themselves

  SceneFile frozen(float time) const {
    SceneFile file;
    for (const Morph& morph : morphs) file.meshes.push_back(morph.frozen(time));
    for (const Mover& mover : movers) file.instances.push_back({mover.mesh, mover.frozen(time)});
    return kiwami::tools::flatten(file);
  }
};

/// The world in Embree. Hits name the mesh, or the instance.
class EmbreeWorld {
 public:
  explicit EmbreeWorld(const MovingWorld& world) {
    std::vector<RTCGeometry> meshes;
    for (const Morph& morph : world.morphs) meshes.push_back(make(morph));
    if (world.movers.empty()) {
      scene_ = scene_of(meshes);
      return;
    }
    for (RTCGeometry mesh : meshes) shown_.push_back(scene_of({mesh}));
    std::vector<RTCGeometry> instances;
    for (const Mover& mover : world.movers) instances.push_back(make(mover));
    scene_ = scene_of(instances);
  }
  ~EmbreeWorld() {
    rtcReleaseScene(scene_);
    for (RTCScene one : shown_) rtcReleaseScene(one);
    rtcReleaseDevice(device_);
  }
  EmbreeWorld(const EmbreeWorld&) = delete;
  EmbreeWorld& operator=(const EmbreeWorld&) = delete;

  kiwami_hit closest_hit(const kiwami_ray& ray) const {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit query{};
    query.ray = {ray.origin_x,
                 ray.origin_y,
                 ray.origin_z,
                 ray.tmin,
                 ray.direction_x,
                 ray.direction_y,
                 ray.direction_z,
                 ray.time,
                 ray.tmax,
                 ~0u,
                 0,
                 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene_, &context, &query);
    kiwami_hit hit{};
    hit.t = std::numeric_limits<float>::infinity();
    hit.primitive_id = hit.geometry_id = hit.instance_id = KIWAMI_INVALID_ID;
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
      hit.t = query.ray.tfar;
      hit.primitive_id = query.hit.primID;
      hit.geometry_id = shown_.empty() ? query.hit.geomID : query.hit.instID[0];
    }
    return hit;
  }

 private:
  RTCGeometry make(const Morph& morph) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_TRIANGLE);
    rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(morph.steps.size()));
    for (size_t step = 0; step < morph.steps.size(); ++step) {
      const std::vector<float>& vertices = morph.steps[step];
      std::memcpy(
          rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, static_cast<unsigned>(step),
                                  RTC_FORMAT_FLOAT3, 12, vertices.size() / 3),
          vertices.data(), vertices.size() * sizeof(float));
    }
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                        morph.mesh.triangle_count()),
                morph.mesh.indices.data(), morph.mesh.indices.size() * sizeof(uint32_t));
    return geometry;
  }
  RTCGeometry make(const Mover& mover) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, shown_[mover.mesh]);
    rtcSetGeometryTimeStepCount(geometry, 2);
    for (unsigned step = 0; step < 2; ++step) {
      if (mover.is_turning) {
        RTCQuaternionDecomposition turn;
        std::memcpy(&turn, &mover.turns[step], sizeof turn);
        rtcSetGeometryTransformQuaternion(geometry, step, &turn);
      } else {
        rtcSetGeometryTransform(geometry, step, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                                mover.matrices[step].data());
      }
    }
    return geometry;
  }
  RTCScene scene_of(const std::vector<RTCGeometry>& geometries) {
    RTCScene scene = rtcNewScene(device_);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    for (RTCGeometry geometry : geometries) {
      rtcCommitGeometry(geometry);
      rtcAttachGeometry(scene, geometry);
      rtcReleaseGeometry(geometry);
    }
    rtcCommitScene(scene);
    return scene;
  }

  RTCDevice device_ = rtcNewDevice("threads=1");
  RTCScene scene_ = nullptr;
  std::vector<RTCScene> shown_;
};

/// The world here.
class OwnWorld {
 public:
  explicit OwnWorld(const MovingWorld& world) {
    if (world.movers.empty()) {
      scene_ = make_scene(device_.get(), Scene{}, {});
      for (const Morph& morph : world.morphs) attach(scene_, make(morph));
    } else {
      std::vector<kiwami_scene*> handles;
      for (const Morph& morph : world.morphs) {
        shown_.push_back(make_scene(device_.get(), Scene{}, {}));
        attach(shown_.back(), make(morph));
        check(kiwami_scene_commit(shown_.back().get()));
        handles.push_back(shown_.back().get());
      }
      scene_ = make_scene(device_.get(), Scene{}, {});
      for (const Mover& mover : world.movers) attach(scene_, make(mover, handles));
    }
    check(kiwami_scene_commit(scene_.get()));
  }

  std::vector<kiwami_hit> closest_hits(const std::vector<kiwami_ray>& rays) const {
    std::vector<kiwami_hit> hits = kiwami_tests::closest_hits(scene_.get(), rays);
    for (kiwami_hit& hit : hits) {
      if (hit.instance_id != KIWAMI_INVALID_ID) hit.geometry_id = hit.instance_id;
      hit.instance_id = KIWAMI_INVALID_ID;
    }
    return hits;
  }

 private:
  static void attach(const SceneHandle& scene, const GeometryHandle& geometry) {
    check(kiwami_scene_attach(scene.get(), geometry.get(), nullptr));
  }
  GeometryHandle make(const Morph& morph) const {
    std::vector<float> vertices;
    for (const auto& step : morph.steps) vertices.insert(vertices.end(), step.begin(), step.end());
    kiwami_moving_mesh_desc desc;
    check(kiwami_moving_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = vertices.data();
    desc.vertex_count = morph.mesh.vertex_count();
    desc.indices = morph.mesh.indices.data();
    desc.triangle_count = morph.mesh.triangle_count();
    desc.step_count = static_cast<uint32_t>(morph.steps.size());
    kiwami_geometry* geometry = nullptr;
    check(kiwami_moving_mesh_create(device_.get(), &desc, &geometry));
    return GeometryHandle(geometry);
  }
  GeometryHandle make(const Mover& mover, const std::vector<kiwami_scene*>& scenes) const {
    kiwami_moving_instances_desc desc;
    check(kiwami_moving_instances_desc_init(&desc, sizeof desc));
    desc.scenes = scenes.data();
    desc.scene_count = scenes.size();
    desc.scene_indices = &mover.mesh;
    desc.count = 1;
    desc.format = mover.is_turning ? KIWAMI_TRANSFORM_QUATERNION : KIWAMI_TRANSFORM_MATRIX;
    desc.transforms = mover.is_turning ? static_cast<const void*>(mover.turns.data())
                                       : static_cast<const void*>(mover.matrices.data());
    kiwami_geometry* geometry = nullptr;
    check(kiwami_moving_instances_create(device_.get(), &desc, &geometry));
    return GeometryHandle(geometry);
  }

  DeviceHandle device_ = make_device(KIWAMI_ISA_AUTO, 1);
  std::vector<SceneHandle> shown_;
  SceneHandle scene_;
};

/// At a time, from around the world to points of its triangles, and some past them.
std::vector<kiwami_ray> rays_at(const SceneFile& flat, float time, size_t count, Random& random) {
  std::vector<kiwami_ray> rays;
  float size = 0.0f;
  for (const ToolMesh& mesh : flat.meshes) {
    for (const float coordinate : mesh.vertices) size = std::max(size, std::fabs(coordinate));
  }
  const auto point = [&](float reach) {
    return Point{random.symmetric() * reach, random.symmetric() * reach,
                 random.symmetric() * reach};
  };
  while (rays.size() < count) {
    const ToolMesh& mesh = flat.meshes[random.below(static_cast<uint32_t>(flat.meshes.size()))];
    const auto triangle = random.below(static_cast<uint32_t>(mesh.triangle_count()));
    Point middle{0, 0, 0};
    for (size_t k = 0; k < 3; ++k) {
      const float* vertex = &mesh.vertices[size_t{3} * mesh.indices[3 * triangle + k]];
      middle = middle + Point{vertex[0], vertex[1], vertex[2]} * (1.0f / 3.0f);
    }
    const Point origin = point(2.0f * size);
    const Point target = random.one_in(3) ? point(size) : middle + point(0.01f * size);
    kiwami_ray ray = ray_from(origin, target - origin);
    ray.time = time;
    rays.push_back(ray);
  }
  return rays;
}

using Tally = std::array<uint64_t, kiwami::tools::kAgreementCount>;

/// How far apart hits on one triangle may be, as a part of the distance.
constexpr float kMostApart = 1e-3f;

/// Some times of a world.
void compare(const MovingWorld& world, size_t ray_count, Random& random, Tally& tally) {
  const EmbreeWorld embree(world);
  const OwnWorld own_world(world);
  for (const float time : {0.0f, 1.0f, 0.5f, random.unit(), random.unit(), random.unit()}) {
    const SceneFile flat = world.frozen(time);
    const std::vector<kiwami_ray> rays = rays_at(flat, time, ray_count, random);
    const std::vector<kiwami_hit> own = own_world.closest_hits(rays);
    for (size_t i = 0; i < rays.size(); ++i) {
      const kiwami_hit reference = embree.closest_hit(rays[i]);
      const Agreement agreement = kiwami::tools::compare_hits(flat, rays[i], own[i], reference);
      ++tally[static_cast<size_t>(agreement)];
      EXPECT_NE(agreement, Agreement::kWrong)
          << "time " << time << ", " << describe(rays[i]) << "\n  own    " << describe(own[i])
          << "\n  Embree " << describe(reference);
      const bool is_same = own[i].primitive_id == reference.primitive_id &&
                           own[i].geometry_id == reference.geometry_id &&
                           own[i].primitive_id != KIWAMI_INVALID_ID;
      // A triangle that is seen from its edge is anywhere.
      if (!is_same || agreement == Agreement::kOwnDistanceOff) continue;
      EXPECT_LE(std::fabs(own[i].t - reference.t), kMostApart * std::max(own[i].t, 1.0f))
          << "time " << time << ", " << describe(rays[i]);
    }
  }
}

void expect_few_exceptions(const Tally& tally, uint64_t share) {
  for (size_t kind = 0; kind < tally.size(); ++kind) {
    if (tally[kind] == 0) continue;
    std::printf("  %10llu  %s\n", static_cast<unsigned long long>(tally[kind]),
                kiwami::tools::agreement_name(static_cast<Agreement>(kind)));
  }
  const auto count = [&](Agreement kind) { return tally[static_cast<size_t>(kind)]; };
  EXPECT_GT(count(Agreement::kSamePrimitive), count(Agreement::kBothMiss) / 4);
  EXPECT_LT(count(Agreement::kReferenceMissed) + count(Agreement::kReferenceFalseHit),
            count(Agreement::kSamePrimitive) / share + 5);
}

Morph random_morph(Random& random, uint32_t triangles, uint32_t steps) {
  Morph morph;
  for (uint32_t i = 0; i < 3 * triangles; ++i) {
    morph.mesh.indices.push_back(i);
    for (int axis = 0; axis < 3; ++axis) morph.mesh.vertices.push_back(random.symmetric());
  }
  morph.steps.push_back(morph.mesh.vertices);
  while (morph.steps.size() < steps) {
    std::vector<float> next = morph.steps.back();
    for (float& coordinate : next) coordinate += 0.3f * random.symmetric();
    morph.steps.push_back(next);
  }
  return morph;
}

Mover random_mover(Random& random, uint32_t mesh_count, bool is_turning) {
  Mover mover{random.below(mesh_count), {}, {}, is_turning};
  for (size_t step = 0; step < 2; ++step) {
    auto& turn = mover.turns[step];
    float* const entries = &turn.scale_x;
    for (int k = 0; k < 16; ++k) {
      entries[k] = k < 3 ? 0.7f + 0.6f * random.unit() : random.symmetric();
      if (3 <= k && k < 6) entries[k] *= 0.3f;
      if (k >= 13) entries[k] *= 3.0f;
    }
    // Embree takes unit quaternions alone.
    const Quaternion unit =
        slerp({turn.quaternion_r, turn.quaternion_i, turn.quaternion_j, turn.quaternion_k + 2.0f},
              {1, 0, 0, 0}, 0.0);
    for (size_t k = 0; k < 4; ++k) (&turn.quaternion_r)[k] = static_cast<float>(unit[k]);
    const std::array<double, 12> matrix = matrix_between(turn, turn, 0.0);
    for (size_t i = 0; i < 12; ++i) {
      mover.matrices[step][i] =
          step == 0 ? static_cast<float>(matrix[i])
                    : mover.matrices[0][i] + (i % 4 == 3 ? 2.0f : 0.2f) * random.symmetric();
    }
  }
  return mover;
}

TEST(EmbreeMotion, OfMeshesAgreesOrDoublePrecisionExplainsIt) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), 61);
  Tally tally{};
  for (uint64_t i = case_budget(8); i != 0; --i) {
    MovingWorld world;
    for (uint32_t k = 1 + random.below(3); k != 0; --k) {
      world.morphs.push_back(random_morph(random, 1 + random.below(80), 2 + random.below(4)));
    }
    compare(world, ray_budget(24000) / 48 + 1, random, tally);
  }
  expect_few_exceptions(tally, 500);
}

TEST(EmbreeMotion, OfPublicKeyframePairsAgreesOrDoublePrecisionExplainsIt) {
  Random random(seed(), 62);
  Tally tally{};
  size_t pairs = 0;
  for (const auto& path : public_scenes()) {
    const std::string name = path.filename().string();
    const size_t at = name.find("_key0");
    if (at == std::string::npos) continue;
    std::string other = name;
    other[at + 4] = '1';
    const SceneFile start = kiwami::tools::load_scene(path);
    const SceneFile end = kiwami::tools::load_scene(path.parent_path() / other);
    MovingWorld world;
    for (size_t i = 0; i < start.meshes.size(); ++i) {
      ASSERT_EQ(start.meshes[i].indices, end.meshes[i].indices);
      world.morphs.push_back({start.meshes[i], {start.meshes[i].vertices, end.meshes[i].vertices}});
    }
    compare(world, ray_budget(3000) / 6 + 1, random, tally);
    ++pairs;
  }
  if (pairs == 0) GTEST_SKIP() << "SKIPPED: no public keyframe pairs; set KIWAMI_SCENES";
  expect_few_exceptions(tally, 100);
}

class EmbreeMovingInstances : public testing::TestWithParam<bool> {};

TEST_P(EmbreeMovingInstances, AgreeOrDoublePrecisionExplainsIt) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), GetParam() ? 64 : 63);
  Tally tally{};
  for (uint64_t i = case_budget(8); i != 0; --i) {
    MovingWorld world;
    for (uint32_t k = 1 + random.below(3); k != 0; --k) {
      world.morphs.push_back(random_morph(random, 1 + random.below(30), 2 + random.below(2)));
    }
    const auto mesh_count = static_cast<uint32_t>(world.morphs.size());
    for (int k = 0; k < 12; ++k) {
      world.movers.push_back(random_mover(random, mesh_count, GetParam()));
    }
    compare(world, ray_budget(24000) / 48 + 1, random, tally);
  }
  expect_few_exceptions(tally, 200);
}

INSTANTIATE_TEST_SUITE_P(Formats, EmbreeMovingInstances, testing::Bool(), [](const auto& test) {
  return std::string(test.param ? "Quaternions" : "Matrices");
});

}  // namespace
}  // namespace kiwami_tests
