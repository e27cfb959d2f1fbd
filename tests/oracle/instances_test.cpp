// SPDX-License-Identifier: Apache-2.0
// One level of instances against Embree's, with a mask for each. Double precision decides by the
// flattened triangles wherever the two disagree.
#include <embree3/rtcore.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstring>
#include <limits>

#include "measure/double_judge.h"
#include "measure/library.h"
#include "measure/tracer.h"
#include "scene/scene_file.h"
#include "support/environment.h"
#include "support/library.h"
#include "support/random.h"
#include "support/ray_generator.h"
#include "support/report.h"
#include "support/scene_graph.h"

namespace kiwami_tests {
namespace {

using kiwami::tools::Agreement;
using kiwami::tools::SceneFile;

/// A graph of one level as a file: all meshes of the shown scenes are one.
struct OneLevel {
  SceneFile file;
  std::vector<uint32_t> masks;  ///< of each instance
};

OneLevel random_one_level(Random& random) {
  OneLevel made;
  const uint32_t mesh_count = 1 + random.below(4);
  for (uint32_t m = 0; m < mesh_count; ++m) {
    kiwami::tools::Mesh mesh;
    for (uint32_t i = 0, count = 1 + random.below(60); i < count * 3; ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        mesh.vertices.push_back(random.symmetric() * (i % 3 == 0 ? 1.0f : 0.6f));
      }
      mesh.indices.push_back(i);
    }
    made.file.meshes.push_back(mesh);
  }
  // A graph of depth 1 has transforms of all kinds.
  while (made.file.instances.size() < 40) {
    const SceneGraph graph = random_scene_graph(random, 1, 1000);
    for (const InstanceArray& array : graph.scenes.back().arrays) {
      for (const Matrix34& transform : array.transforms) {
        made.file.instances.push_back({random.below(mesh_count), transform});
        made.masks.push_back(random.one_in(2) ? ~0u : random.bits());
      }
    }
  }
  return made;
}

/// The closest hits of Embree, which names the instance as geometry.
std::vector<kiwami_hit> embree_hits(const OneLevel& level, const std::vector<kiwami_ray>& rays) {
  RTCDevice device = rtcNewDevice("threads=1");
  const auto new_scene = [&] {
    RTCScene scene = rtcNewScene(device);
    rtcSetSceneFlags(scene, RTC_SCENE_FLAG_ROBUST);
    return scene;
  };
  std::vector<RTCScene> shown;
  for (const auto& mesh : level.file.meshes) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 12,
                                        mesh.vertex_count()),
                mesh.vertices.data(), mesh.vertices.size() * sizeof(float));
    std::memcpy(rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 12,
                                        mesh.triangle_count()),
                mesh.indices.data(), mesh.indices.size() * sizeof(uint32_t));
    rtcCommitGeometry(geometry);
    shown.push_back(new_scene());
    rtcAttachGeometry(shown.back(), geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(shown.back());
  }
  RTCScene scene = new_scene();
  for (size_t i = 0; i < level.file.instances.size(); ++i) {
    RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(geometry, shown[level.file.instances[i].mesh]);
    rtcSetGeometryTransform(geometry, 0, RTC_FORMAT_FLOAT3X4_ROW_MAJOR,
                            level.file.instances[i].transform.data());
    rtcSetGeometryMask(geometry, level.masks[i]);
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene, geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene);
  std::vector<kiwami_hit> hits;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  for (const kiwami_ray& ray : rays) {
    RTCRayHit query{};
    query.ray = {ray.origin_x,
                 ray.origin_y,
                 ray.origin_z,
                 ray.tmin,
                 ray.direction_x,
                 ray.direction_y,
                 ray.direction_z,
                 0,
                 ray.tmax,
                 ray.mask,
                 0,
                 0};
    query.hit.geomID = query.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene, &context, &query);
    kiwami_hit hit{};
    hit.t = std::numeric_limits<float>::infinity();
    hit.primitive_id = hit.geometry_id = hit.instance_id = KIWAMI_INVALID_ID;
    if (query.hit.geomID != RTC_INVALID_GEOMETRY_ID) {
      hit.t = query.ray.tfar;
      hit.primitive_id = query.hit.primID;
      hit.geometry_id = query.hit.instID[0];
    }
    hits.push_back(hit);
  }
  for (RTCScene one : shown) rtcReleaseScene(one);
  rtcReleaseScene(scene);
  rtcReleaseDevice(device);
  return hits;
}

std::vector<kiwami_hit> own_hits(const OneLevel& level, const std::vector<kiwami_ray>& rays) {
  const DeviceHandle device = make_device(KIWAMI_ISA_AUTO, 1);
  SceneGraph graph;
  for (const auto& mesh : level.file.meshes) {
    Mesh copy;
    for (size_t i = 0; i < mesh.vertices.size(); i += 3) {
      copy.vertices.push_back({mesh.vertices[i], mesh.vertices[i + 1], mesh.vertices[i + 2]});
    }
    for (size_t i = 0; i < mesh.indices.size(); i += 3) {
      copy.triangles.push_back({mesh.indices[i], mesh.indices[i + 1], mesh.indices[i + 2]});
    }
    graph.scenes.push_back({{copy}, {}});
  }
  InstanceArray array;
  for (const auto& instance : level.file.instances) {
    array.shown.push_back(instance.mesh);
    array.transforms.push_back(instance.transform);
  }
  array.masks = level.masks;
  graph.scenes.push_back({{}, {array}});
  const std::vector<SceneHandle> scenes = build(device.get(), graph, 0);
  std::vector<kiwami_hit> hits = closest_hits(scenes.back().get(), rays);
  for (kiwami_hit& hit : hits) {
    if (hit.primitive_id == KIWAMI_INVALID_ID) continue;
    hit.geometry_id = hit.instance_id;
    hit.instance_id = KIWAMI_INVALID_ID;
  }
  return hits;
}

kiwami_ray random_ray(Random& random) {
  const auto point = [&](float size) {
    return Point{random.symmetric() * size, random.symmetric() * size, random.symmetric() * size};
  };
  const Point origin = point(random.one_in(3) ? 20.0f : 4.0f);
  kiwami_ray ray = ray_from(origin, point(3.0f) - origin);
  if (random.one_in(2)) ray.mask = 1u << random.below(32);
  return ray;
}

TEST(EmbreeInstances, AgreeWithMasksOrDoublePrecisionExplainsIt) {
  std::printf("KIWAMI_SEED=%llu\n", static_cast<unsigned long long>(seed()));
  Random random(seed(), 41);
  std::array<uint64_t, kiwami::tools::kAgreementCount> tally{};
  for (uint64_t number = case_budget(20); number != 0; --number) {
    const OneLevel level = random_one_level(random);
    const SceneFile flat = kiwami::tools::flatten(level.file);
    std::vector<kiwami_ray> rays;
    for (uint64_t i = ray_budget(40000) / 20 + 1; i != 0; --i) rays.push_back(random_ray(random));
    const std::vector<kiwami_hit> own = own_hits(level, rays);
    const std::vector<kiwami_hit> reference = embree_hits(level, rays);
    for (size_t i = 0; i < rays.size(); ++i) {
      const Agreement agreement = kiwami::tools::compare_hits(flat, rays[i], own[i], reference[i]);
      ++tally[static_cast<size_t>(agreement)];
      EXPECT_NE(agreement, Agreement::kWrong)
          << describe(rays[i]) << "\n  own    " << describe(own[i]) << "\n  Embree "
          << describe(reference[i]);
    }
  }
  for (size_t kind = 0; kind < tally.size(); ++kind) {
    if (tally[kind] == 0) continue;
    std::printf("  %10llu  %s\n", static_cast<unsigned long long>(tally[kind]),
                kiwami::tools::agreement_name(static_cast<Agreement>(kind)));
  }
  const auto count = [&](Agreement kind) { return tally[static_cast<size_t>(kind)]; };
  EXPECT_GT(count(Agreement::kSamePrimitive), count(Agreement::kBothMiss) / 4);
  EXPECT_GT(count(Agreement::kBothMiss), 0u);
  // Exceptions are few.
  EXPECT_LT(count(Agreement::kReferenceMissed) + count(Agreement::kReferenceFalseHit),
            count(Agreement::kSamePrimitive) / 1000 + 5);
}

/// Every so many of the instances, so that they come to at most so many triangles.
SceneFile thinned(SceneFile file, uint64_t max_triangles) {
  const uint64_t step = file.triangle_count() / max_triangles + 1;
  std::vector<kiwami::tools::Instance> kept;
  for (size_t i = 0; i < file.instances.size(); i += step) kept.push_back(file.instances[i]);
  file.instances = kept;
  return file;
}

/// Public scenes with instances: ours, of instances, against Embree with the flattened triangles.
TEST(EmbreeInstances, OfPublicScenesAgreeWithTheFlattenedTriangles) {
  size_t scenes = 0;
  for (const auto& path : public_scenes()) {
    if (!path.filename().string().ends_with(".ins.gz")) continue;
    ++scenes;
    const SceneFile file = thinned(kiwami::tools::load_scene(path), public_scene_limit());
    const SceneFile flat = kiwami::tools::flatten(file);
    const kiwami::tools::Device device(KIWAMI_ISA_AUTO, 1);
    const kiwami::tools::BuiltScene built(device, file);
    const kiwami_scene_info& info = built.info();
    Random random(seed(), 42);
    std::vector<kiwami_ray> rays;
    for (uint64_t i = ray_budget(20000); i != 0; --i) {
      const auto point = [&] {
        Point p;
        for (int axis = 0; axis < 3; ++axis) {
          p[axis] = info.bounds_min[axis] +
                    random.unit() * (info.bounds_max[axis] - info.bounds_min[axis]);
        }
        return p;
      };
      const Point origin = point();
      rays.push_back(ray_from(origin, point() - origin));
    }
    std::vector<kiwami_hit> own(rays.size()), reference(rays.size());
    built.closest_hits(rays, own);
    kiwami::tools::EmbreeTracer::create(flat, true)->closest_hits(rays, reference);
    size_t hits = 0;
    for (size_t i = 0; i < rays.size(); ++i) {
      hits += own[i].primitive_id != KIWAMI_INVALID_ID;
      EXPECT_NE(kiwami::tools::compare_hits(flat, rays[i], own[i], reference[i]), Agreement::kWrong)
          << describe(rays[i]) << "\n  own    " << describe(own[i]) << "\n  Embree "
          << describe(reference[i]);
    }
    std::printf("%s: %zu instances, %llu triangles, %zu of %zu rays hit\n", path.filename().c_str(),
                file.instances.size(), static_cast<unsigned long long>(flat.triangle_count()), hits,
                rays.size());
    EXPECT_GT(hits, rays.size() / 100);
  }
  if (scenes == 0) GTEST_SKIP() << "SKIPPED: no public scenes; set KIWAMI_SCENES";
}

}  // namespace
}  // namespace kiwami_tests
