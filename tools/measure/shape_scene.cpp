// SPDX-License-Identifier: Apache-2.0
#include "measure/shape_scene.h"

namespace kiwami::tools {
namespace {

void check(kiwami_result result) {
  if (result == KIWAMI_OK) return;
  char sentence[1024];
  kiwami_last_error(nullptr, sentence, sizeof sentence);
  throw LibraryError(result, sentence);
}

kiwami_geometry* make_spheres(kiwami_device* device, const ShapeCloud& cloud) {
  kiwami_spheres_desc desc;
  check(kiwami_spheres_desc_init(&desc, sizeof desc));
  desc.points = cloud.points.data();
  desc.sphere_count = cloud.count();
  kiwami_geometry* geometry = nullptr;
  check(kiwami_spheres_create(device, &desc, &geometry));
  return geometry;
}

kiwami_geometry* make_discs(kiwami_device* device, const ShapeCloud& cloud) {
  kiwami_discs_desc desc;
  check(kiwami_discs_desc_init(&desc, sizeof desc));
  desc.points = cloud.points.data();
  desc.normals = cloud.normals.data();
  desc.disc_count = cloud.count();
  kiwami_geometry* geometry = nullptr;
  check(kiwami_discs_create(device, &desc, &geometry));
  return geometry;
}

kiwami_geometry* make_curves(kiwami_device* device, const ShapeCloud& cloud) {
  kiwami_curves_desc desc;
  check(kiwami_curves_desc_init(&desc, sizeof desc));
  desc.points = cloud.points.data();
  desc.point_count = cloud.points.size() / 4;
  desc.indices = cloud.indices.data();
  desc.segment_count = cloud.count();
  kiwami_geometry* geometry = nullptr;
  check(kiwami_curves_create(device, &desc, &geometry));
  return geometry;
}

}  // namespace

ShapeScene::ShapeScene(const Device& device, const ShapeCloud& cloud) {
  kiwami_geometry* const geometry =
      cloud.kind == CloudKind::kSpheres ? make_spheres(device.get(), cloud)
      : cloud.kind == CloudKind::kDiscs ? make_discs(device.get(), cloud)
                                        : make_curves(device.get(), cloud);
  try {
    check(kiwami_scene_create(device.get(), &scene_));
    check(kiwami_scene_attach(scene_, geometry, nullptr));
    check(kiwami_scene_commit(scene_));
    info_.struct_size = sizeof info_;
    check(kiwami_scene_get_info(scene_, &info_));
  } catch (...) {
    kiwami_geometry_release(geometry);
    kiwami_scene_release(scene_);
    throw;
  }
  kiwami_geometry_release(geometry);
}

void ShapeScene::closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const {
  check(kiwami_closest_hit(scene_, rays.data(), 0, hits.data(), 0, rays.size(), nullptr));
}

void ShapeScene::any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const {
  check(kiwami_any_hit(scene_, rays.data(), 0, occluded.data(), 0, rays.size(), nullptr));
}

}  // namespace kiwami::tools
