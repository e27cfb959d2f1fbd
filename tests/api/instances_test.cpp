// SPDX-License-Identifier: Apache-2.0
// Instances through the C interface: what they show, and what hits say of them.
#include <cstring>

#include "api/instances_support.h"
#include "support/random.h"

namespace kiwami_api_tests {
namespace {

using kiwami_tests::Random;

TEST_F(Instances, ShowTheirSceneWhereTheTransformsSay) {
  const Scene scene =
      scene_of({{child_.get()}, {}, {translation(0, 0, 5), translation(10, 0, 2)}, {}});
  const PathHit first = trace(scene, ray_at(0.5f, 0.25f));
  EXPECT_EQ(first.hit.t, 15.0f);
  EXPECT_EQ(first.hit.instance_id, 0u);
  EXPECT_EQ(first.hit.geometry_id, 0u);
  EXPECT_EQ(first.path[0], 0u);
  for (size_t i = 1; i < first.path.size(); ++i) EXPECT_EQ(first.path[i], KIWAMI_INVALID_ID);
  const PathHit second = trace(scene, ray_at(10.5f, 0.25f));
  EXPECT_EQ(second.hit.t, 12.0f);
  EXPECT_EQ(second.hit.instance_id, 1u);
  // The same triangle at the same place of it.
  EXPECT_EQ(second.hit.primitive_id, first.hit.primitive_id);
  EXPECT_EQ(second.hit.u, first.hit.u);
  const PathHit miss = trace(scene, ray_at(5.0f, 0.0f));
  EXPECT_EQ(miss.hit.primitive_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(miss.hit.instance_id, KIWAMI_INVALID_ID);
  for (const uint32_t number : miss.path) EXPECT_EQ(number, KIWAMI_INVALID_ID);
}

TEST_F(Instances, AnswerAnyHitAndCounts) {
  const Scene scene =
      scene_of({{child_.get()}, {}, {translation(0, 0, 5), translation(0, 0, 2)}, {}});
  const kiwami_ray rays[] = {ray_at(0.5f, 0.25f), ray_at(5, 5)};
  uint8_t occluded[2];
  ASSERT_EQ(kiwami_any_hit(scene.get(), rays, 0, occluded, 0, 2, nullptr), KIWAMI_OK);
  EXPECT_EQ(occluded[0], 1);
  EXPECT_EQ(occluded[1], 0);
  uint32_t counts[2];
  ASSERT_EQ(kiwami_count_hits(scene.get(), rays, 0, counts, 0, 2, nullptr), KIWAMI_OK);
  EXPECT_EQ(counts[0], 2u);
  EXPECT_EQ(counts[1], 0u);
}

TEST_F(Instances, KeepTheDistanceUnderScale) {
  const Scene scene = scene_of({{child_.get()}, {}, {scaling(4, 2, 8)}, {}});
  kiwami_ray ray = ray_at(3.0f, 1.5f);
  ray.direction_z = 0.5f;
  const PathHit answer = trace(scene, ray);
  EXPECT_EQ(answer.hit.t, 20.0f);
  // The normal is that of the square, in its own space.
  EXPECT_EQ(answer.hit.normal_x, 0.0f);
  EXPECT_EQ(answer.hit.normal_y, 0.0f);
  EXPECT_EQ(answer.hit.normal_z, 4.0f);
}

TEST_F(Instances, AreNumberedThroughByGeometryAndIndex) {
  const Scene scene = make_scene(device_);
  const Geometry a = make({{child_.get()}, {}, {translation(0, 0, 0), translation(10, 0, 0)}, {}});
  const Geometry b = make({{child_.get()}, {}, {translation(20, 0, 0), translation(30, 0, 0)}, {}});
  uint32_t id = 0;
  ASSERT_EQ(kiwami_scene_attach(scene.get(), a.get(), &id), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), mesh_.get(), &id), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), b.get(), &id), KIWAMI_OK);
  EXPECT_EQ(id, 2u);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  for (uint32_t i = 0; i < 4; ++i) {
    // The mesh lies where the first instance is, and a hit outside instances comes first.
    const PathHit answer = trace(scene, ray_at(10.0f * static_cast<float>(i) + 0.5f, 0.25f));
    EXPECT_EQ(answer.hit.instance_id, i == 0 ? KIWAMI_INVALID_ID : i);
    EXPECT_EQ(answer.hit.geometry_id, i == 0 ? 1u : 0u);
  }
  EXPECT_EQ(kiwami_scene_detach(scene.get(), 0), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(trace(scene, ray_at(20.5f, 0.25f)).hit.instance_id, 0u);
  EXPECT_EQ(trace(scene, ray_at(10.5f, 0.25f)).hit.primitive_id, KIWAMI_INVALID_ID);
}

TEST_F(Instances, OfEqualHitsTheLeastNumberComesFirst) {
  const Scene scene = scene_of({{child_.get()}, {}, std::vector<Matrix>(40, kIdentity), {}});
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.instance_id, 0u);
}

TEST_F(Instances, ShowSeveralScenesByIndex) {
  const Triangles other = square(1.0f);
  const Geometry other_mesh = make_mesh(device_, other.desc());
  const Scene other_child = make_scene(device_, other_mesh);
  const Scene scene =
      scene_of({{child_.get(), other_child.get()},
                {1, 0, 1},
                {translation(0, 0, 0), translation(10, 0, 0), translation(20, 0, 0)},
                {}});
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 11.0f);
  EXPECT_EQ(trace(scene, ray_at(10.5f, 0.25f)).hit.t, 10.0f);
  EXPECT_EQ(trace(scene, ray_at(20.5f, 0.25f)).hit.t, 11.0f);
}

TEST_F(Instances, AreEnteredByMasks) {
  Group group{{child_.get()}, {}, {translation(0, 0, 1), translation(0, 0, 2)}, {1, 6}};
  kiwami_instances_desc desc = group.desc();
  desc.mask = 5;
  const Scene scene = make_scene(device_, make(desc));
  const auto number_for = [&](uint32_t mask) {
    kiwami_ray ray = ray_at(0.5f, 0.25f);
    ray.mask = mask;
    return trace(scene, ray).hit.instance_id;
  };
  EXPECT_EQ(number_for(1), 0u);
  EXPECT_EQ(number_for(2), KIWAMI_INVALID_ID);  // The array's mask has no such bit.
  EXPECT_EQ(number_for(4), 1u);
  EXPECT_EQ(number_for(5), 0u);
  EXPECT_EQ(number_for(8), KIWAMI_INVALID_ID);
}

TEST_F(Instances, MasksInsideCountAsWell) {
  kiwami_triangle_mesh_desc mesh = square_.desc();
  mesh.mask = 2;
  const Geometry masked = make_mesh(device_, mesh);
  const Scene child = make_scene(device_, masked);
  const Scene scene = scene_of({{child.get()}, {}, {kIdentity}, {3}});
  kiwami_ray ray = ray_at(0.5f, 0.25f);
  ray.mask = 1;
  EXPECT_EQ(trace(scene, ray).hit.instance_id, KIWAMI_INVALID_ID);
  ray.mask = 2;
  EXPECT_EQ(trace(scene, ray).hit.instance_id, 0u);
}

/// The square shows its back to rays along +z. A mirror along z turns it around in the outer space,
/// but facing is decided in the space of the square: there the ray is mirrored, and runs along -z.
/// A mirror along x leaves the ray as it is there.
TEST_F(Instances, FacingIsDecidedInTheSpaceOfTheScene) {
  const Scene scene =
      scene_of({{child_.get()}, {}, {kIdentity, scaling(1, 1, -1), scaling(-1, 1, 1)}, {1, 2, 4}});
  const auto is_met = [&](uint32_t mask, uint32_t flags) {
    kiwami_ray ray = ray_at(0.5f, 0.25f);
    ray.mask = mask;
    ray.flags = flags;
    return trace(scene, ray).hit.instance_id != KIWAMI_INVALID_ID;
  };
  EXPECT_FALSE(is_met(1, KIWAMI_RAY_CULL_BACK_FACES));
  EXPECT_TRUE(is_met(1, KIWAMI_RAY_CULL_FRONT_FACES));
  EXPECT_TRUE(is_met(2, KIWAMI_RAY_CULL_BACK_FACES));
  EXPECT_FALSE(is_met(2, KIWAMI_RAY_CULL_FRONT_FACES));
  EXPECT_FALSE(is_met(4, KIWAMI_RAY_CULL_BACK_FACES));
  EXPECT_TRUE(is_met(4, KIWAMI_RAY_CULL_FRONT_FACES));
}

TEST_F(Instances, NestToTheGreatestDepth) {
  std::vector<Scene> scenes;
  kiwami_scene* shown = child_.get();
  for (uint32_t depth = 1; depth <= KIWAMI_MAX_INSTANCE_DEPTH; ++depth) {
    // The instance on the path has the number of its depth.
    std::vector<Matrix> transforms(depth + 1, translation(1000, 0, 0));
    transforms[depth] = translation(0, 0, 1);
    scenes.push_back(scene_of({{shown}, {}, transforms, {}}));
    shown = scenes.back().get();
    const PathHit answer = trace(scenes.back(), ray_at(0.5f, 0.25f));
    EXPECT_EQ(answer.hit.t, 10.0f + static_cast<float>(depth));
    EXPECT_EQ(answer.hit.instance_id, depth);
    for (uint32_t i = 0; i < KIWAMI_MAX_INSTANCE_DEPTH; ++i) {
      EXPECT_EQ(answer.path[i], i < depth ? depth - i : KIWAMI_INVALID_ID);
    }
    EXPECT_EQ(info_of(scenes.back()).instance_depth, depth);
  }
  const Geometry deeper = make({{shown}, {}, {kIdentity}, {}});
  const Scene scene = make_scene(device_);
  ASSERT_EQ(kiwami_scene_attach(scene.get(), deeper.get(), nullptr), KIWAMI_OK);
  expect_commit_fails(scene, KIWAMI_ERROR_TOO_LARGE,
                      "scene 0 of geometry 0 has paths of 8 instances, expected at most 7 here");
}

TEST_F(Instances, CommitsCaptureWhatTheirScenesHaveCommitted) {
  const Scene child = make_scene(device_, mesh_);
  const Scene scene = scene_of({{child.get()}, {}, {kIdentity}, {}});
  const Triangles nearer = square(-1.0f);
  const Geometry second = make_mesh(device_, nearer.desc());
  ASSERT_EQ(kiwami_scene_attach(child.get(), second.get(), nullptr), KIWAMI_OK);
  ASSERT_EQ(kiwami_scene_commit(child.get()), KIWAMI_OK);
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 10.0f);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 9.0f);
}

TEST_F(Instances, HoldWhatTheyShow) {
  Geometry geometry;
  {
    const Scene child = make_scene(device_, mesh_);
    geometry = make({{child.get()}, {}, {kIdentity}, {}});
  }
  const Scene scene = make_scene(device_, geometry);
  geometry.reset();
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 10.0f);
}

TEST_F(Instances, OfScenesWithoutTrianglesAreNeverHit) {
  const Scene empty = make_scene(device_);
  ASSERT_EQ(kiwami_scene_commit(empty.get()), KIWAMI_OK);
  const Scene nothing = scene_of({{empty.get()}, {}, {kIdentity, kIdentity}, {}});
  EXPECT_EQ(trace(nothing, ray_at(0, 0)).hit.primitive_id, KIWAMI_INVALID_ID);
  EXPECT_EQ(info_of(nothing).bounds_min[0], kInfinity);
  EXPECT_EQ(info_of(nothing).instance_count, 2u);
  // Among others they keep their numbers.
  const Scene scene = scene_of({{empty.get(), child_.get()}, {0, 1}, {kIdentity, kIdentity}, {}});
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.instance_id, 1u);
  EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
}

TEST_F(Instances, TheInfoSpeaksOfThem) {
  const Scene scene = scene_of({{child_.get()}, {}, {translation(0, 0, 5), scaling(2, 2, 2)}, {}});
  const kiwami_scene_info info = info_of(scene);
  EXPECT_EQ(info.instance_count, 2u);
  EXPECT_EQ(info.instance_depth, 1u);
  EXPECT_GT(info.instance_tree_bytes, 0u);
  EXPECT_EQ(info.triangle_count, 0u);
  EXPECT_NEAR(info.bounds_min[0], -2.0f, 1e-6f);
  EXPECT_NEAR(info.bounds_max[2], 5.0f, 1e-6f);
  EXPECT_EQ(info_of(child_).instance_depth, 0u);
}

TEST_F(Instances, SharedBuffersAreReadByEachCommit) {
  Group group{{child_.get()}, {0}, {translation(0, 0, 5)}, {1}};
  kiwami_instances_desc desc = group.desc();
  desc.flags = KIWAMI_INSTANCES_SHARE_BUFFERS;
  const Scene scene = make_scene(device_, make(desc));
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 15.0f);
  group.transforms[0] = translation(0, 0, 7);
  ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 17.0f);
  group.transforms[0] = scaling(1, 0, 1);
  expect_commit_fails(scene, KIWAMI_ERROR_INVALID_ARGUMENT,
                      "the transform of instance 0 is singular or not finite, expected a condition "
                      "number of at most 2^20 and scales from 2^-60 to 2^60");
  group.transforms[0] = kIdentity;
  group.indices[0] = 1;
  expect_commit_fails(scene, KIWAMI_ERROR_INVALID_ARGUMENT,
                      "the scene index of instance 0 is 1, expected less than desc.scene_count, "
                      "which is 1");
  // The last successful commit stays.
  EXPECT_EQ(trace(scene, ray_at(0.5f, 0.25f)).hit.t, 17.0f);
}

TEST_F(Instances, FieldsMayLieAStrideApartAtAnyAddress) {
  std::vector<unsigned char> bytes(4 * 61 + 3);
  for (uint32_t i = 0; i < 4; ++i) {
    unsigned char* element = bytes.data() + 1 + i * 61;
    const Matrix matrix = translation(10.0f * static_cast<float>(i), 0, 0);
    const uint32_t index = 0, mask = 1u << i;
    std::memcpy(element, matrix.data(), 48);
    std::memcpy(element + 48, &index, 4);
    std::memcpy(element + 52, &mask, 4);
  }
  kiwami_scene* scenes[] = {child_.get()};
  kiwami_instances_desc desc = default_instances();
  desc.scenes = scenes;
  desc.scene_count = 1;
  desc.count = 4;
  desc.transforms = bytes.data() + 1;
  desc.scene_indices = bytes.data() + 1 + 48;
  desc.masks = bytes.data() + 1 + 52;
  desc.transform_stride = desc.scene_index_stride = desc.mask_stride = 61;
  for (const uint32_t flags : {0u, uint32_t{KIWAMI_INSTANCES_SHARE_BUFFERS}}) {
    desc.flags = flags;
    const Scene scene = make_scene(device_, make(desc));
    for (uint32_t i = 0; i < 4; ++i) {
      kiwami_ray ray = ray_at(10.0f * static_cast<float>(i) + 0.5f, 0.25f);
      EXPECT_EQ(trace(scene, ray).hit.instance_id, i);
      ray.mask = ~(1u << i);
      EXPECT_EQ(trace(scene, ray).hit.instance_id, KIWAMI_INVALID_ID);
    }
  }
}

TEST_F(Instances, PathsOfBatchesAndOfFields) {
  const Scene scene =
      scene_of({{child_.get()}, {}, {translation(0, 0, 5), translation(10, 0, 2)}, {}});
  constexpr size_t kCount = 10000;
  std::vector<kiwami_ray> rays;
  Random random(kCount);
  for (size_t i = 0; i < kCount; ++i) {
    rays.push_back(ray_at(random.unit() * 12 - 1, random.symmetric()));
  }
  std::vector<uint32_t> paths(kCount * 9, 77), paths_by_fields(kCount * 9, 77);
  std::vector<kiwami_hit> hits(kCount), hits_by_fields(kCount);
  kiwami_query query;
  kiwami_query_init(&query, sizeof query);
  query.instance_paths = paths.data();
  query.instance_path_stride = 36;
  ASSERT_EQ(kiwami_closest_hit(scene.get(), rays.data(), 0, hits.data(), 0, kCount, &query),
            KIWAMI_OK);
  kiwami_ray_fields fields;
  kiwami_ray_fields_init(&fields, sizeof fields);
  const auto input = [&](size_t offset) {
    return kiwami_input_field{reinterpret_cast<unsigned char*>(rays.data()) + offset,
                              sizeof(kiwami_ray)};
  };
  fields.origin_x = input(offsetof(kiwami_ray, origin_x));
  fields.origin_y = input(offsetof(kiwami_ray, origin_y));
  fields.origin_z = input(offsetof(kiwami_ray, origin_z));
  fields.direction_x = input(offsetof(kiwami_ray, direction_x));
  fields.direction_y = input(offsetof(kiwami_ray, direction_y));
  fields.direction_z = input(offsetof(kiwami_ray, direction_z));
  kiwami_hit_fields outputs;
  kiwami_hit_fields_init(&outputs, sizeof outputs);
  outputs.instance_id = {&hits_by_fields[0].instance_id, sizeof(kiwami_hit)};
  query.instance_paths = paths_by_fields.data();
  ASSERT_EQ(kiwami_closest_hit_fields(scene.get(), &fields, &outputs, kCount, &query), KIWAMI_OK);
  size_t met = 0;
  for (size_t i = 0; i < kCount; ++i) {
    EXPECT_EQ(paths[i * 9], hits[i].instance_id);
    EXPECT_EQ(paths[i * 9 + 1], KIWAMI_INVALID_ID);
    EXPECT_EQ(paths[i * 9 + 8], 77u);
    EXPECT_EQ(hits_by_fields[i].instance_id, hits[i].instance_id);
    met += hits[i].instance_id != KIWAMI_INVALID_ID;
  }
  EXPECT_EQ(paths, paths_by_fields);
  EXPECT_GT(met, kCount / 10);
  EXPECT_LT(met, kCount);
}

TEST_F(Instances, VisitsAreCounted) {
  const Scene scene = scene_of({{child_.get()}, {}, {kIdentity, translation(50, 0, 0)}, {}});
  const kiwami_ray ray = ray_at(0.5f, 0.25f);
  kiwami_visits visits{};
  visits.struct_size = sizeof visits;
  ASSERT_EQ(kiwami_scene_count_visits(scene.get(), &ray, 0, 1, 0, &visits, nullptr, 0), KIWAMI_OK)
      << last_error();
  EXPECT_EQ(visits.hit_count, 1u);
  // The leaf of the instance and that of the triangle.
  EXPECT_GE(visits.leaf_visits, 2u);
}

/// Overlapping copies of a mesh: fewer visits, the same answers. Copies that lie apart stay as they
/// are.
TEST_F(Instances, ReBraidingSavesVisitsWhereInstancesOverlap) {
  const Triangles soup = random_triangles(3000, 5);
  const Geometry mesh = make_mesh(device_, soup.desc());
  const Scene child = make_scene(device_, mesh);
  const std::vector<kiwami_ray> rays = random_rays(3000, 6);
  struct Outcome {
    uint64_t nodes, bytes;
    std::vector<kiwami_hit> hits;
  };
  const auto outcome_of = [&](float spacing, uint32_t mode) {
    Group group{{child.get()}, {}, {}, {}};
    for (int i = 0; i < 12; ++i) {
      const float along = static_cast<float>(i) * spacing;
      group.transforms.push_back(translation(along - 6 * spacing, 0.3f * along, 0.1f * along));
    }
    const Geometry geometry = make(group);
    const Scene scene = make_scene(device_);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_REBRAID, mode), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_REBRAID_BUDGET, 20),
              KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_attach(scene.get(), geometry.get(), nullptr), KIWAMI_OK);
    EXPECT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK) << last_error();
    EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
    kiwami_visits visits{};
    visits.struct_size = sizeof visits;
    EXPECT_EQ(
        kiwami_scene_count_visits(scene.get(), rays.data(), 0, rays.size(), 0, &visits, nullptr, 0),
        KIWAMI_OK);
    return Outcome{visits.node_visits, info_of(scene).instance_tree_bytes,
                   closest_hits(scene, rays)};
  };
  const Outcome off = outcome_of(0.15f, KIWAMI_REBRAID_OFF);
  const Outcome full = outcome_of(0.15f, KIWAMI_REBRAID_FULL);
  const Outcome roots = outcome_of(0.15f, KIWAMI_REBRAID_ROOTS);
  EXPECT_TRUE(are_equal(full.hits, off.hits));
  EXPECT_TRUE(are_equal(roots.hits, off.hits));
  EXPECT_LT(full.nodes, off.nodes);
  EXPECT_LT(roots.nodes, off.nodes);
  EXPECT_GT(full.bytes, roots.bytes);
  EXPECT_GT(roots.bytes, off.bytes);
  std::printf("visits of nodes: %llu off, %llu full, %llu roots\n",
              static_cast<unsigned long long>(off.nodes),
              static_cast<unsigned long long>(full.nodes),
              static_cast<unsigned long long>(roots.nodes));
}

/// Beyond its matrix an instance costs at most 100 bytes, the tree included; a little more in nodes
/// of 4, of which there are more, and fewer are full.
TEST_F(Instances, AreSmall) {
  constexpr size_t kCount = 200000;
  std::vector<Matrix> transforms;
  Random random(11);
  for (size_t i = 0; i < kCount; ++i) {
    transforms.push_back(
        translation(1000 * random.unit(), 1000 * random.unit(), 1000 * random.unit()));
  }
  for (const double width : {4.0, 8.0}) {
    Scene child = make_scene(device_);
    kiwami_scene_set_parameter(child.get(), KIWAMI_PARAMETER_BVH_WIDTH, width);
    kiwami_scene_attach(child.get(), mesh_.get(), nullptr);
    ASSERT_EQ(kiwami_scene_commit(child.get()), KIWAMI_OK);
    const Geometry geometry = make({{child.get()}, {}, transforms, {}});
    const Scene scene = make_scene(device_);
    kiwami_scene_set_parameter(scene.get(), KIWAMI_PARAMETER_BVH_WIDTH, width);
    kiwami_scene_attach(scene.get(), geometry.get(), nullptr);
    ASSERT_EQ(kiwami_scene_commit(scene.get()), KIWAMI_OK);
    const double bytes =
        static_cast<double>(info_of(scene).total_bytes) / static_cast<double>(kCount) - 48.0;
    std::printf("%g wide: %.1f bytes an instance beyond its matrix\n", width, bytes);
    EXPECT_LE(bytes, width == 4.0 ? 105.0 : 100.0);
    EXPECT_EQ(kiwami_scene_validate(scene.get()), KIWAMI_OK) << last_error();
  }
}

}  // namespace
}  // namespace kiwami_api_tests
