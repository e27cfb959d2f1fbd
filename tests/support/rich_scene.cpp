// SPDX-License-Identifier: Apache-2.0
#include "support/rich_scene.h"

#include <functional>
#include <vector>

#include "support/library.h"
#include "support/random.h"

namespace kiwami_tests {
namespace {

struct Failure {
  kiwami_result result;
};

void must(kiwami_result result) {
  if (result != KIWAMI_OK) throw Failure{result};
}

struct GeometryRelease {
  void operator()(kiwami_geometry* geometry) const { kiwami_geometry_release(geometry); }
};
using GeometryHandle = std::unique_ptr<kiwami_geometry, GeometryRelease>;

GeometryHandle made(const std::function<kiwami_result(kiwami_geometry**)>& make) {
  kiwami_geometry* geometry = nullptr;
  must(make(&geometry));
  return GeometryHandle(geometry);
}

std::vector<float> symmetric_numbers(size_t count, Random& random) {
  std::vector<float> numbers(count);
  for (float& number : numbers) number = random.symmetric();
  return numbers;
}

/// One scene in the making.
class Maker {
 public:
  Maker(kiwami_device* device, const RichScene& what, uint64_t seed)
      : device_(device), what_(what), random_(seed) {
    kiwami_scene* scene = nullptr;
    must(kiwami_scene_create(device, &scene));
    scene_.reset(scene);
  }

  bool has(uint32_t part) const { return (what_.parts & part) != 0; }

  void add_mesh(bool has_indices, uint32_t mask) {
    const std::vector<float> vertices = small_triangles();
    const std::vector<uint32_t> indices = triangle_indices();
    kiwami_triangle_mesh_desc desc;
    must(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = vertices.data();
    desc.vertex_count = vertices.size() / 3;
    desc.indices = has_indices ? indices.data() : nullptr;
    desc.triangle_count = what_.size;
    desc.mask = mask;
    const GeometryHandle mesh = made([&](kiwami_geometry** geometry) {
      return kiwami_triangle_mesh_create(device_, &desc, geometry);
    });
    if (has(kRichMicromaps)) add_micromaps(mesh.get(), has_indices);
    attach(mesh.get());
  }

  void add_shapes() {
    // Each kind has points of its own, or the first ones would hide the others.
    std::vector<float> points = points_of(what_.size + 1);
    const std::vector<float> normals = symmetric_numbers(3 * what_.size, random_);
    std::vector<uint32_t> indices(what_.size);
    for (uint32_t& index : indices) index = random_.below(what_.size);
    kiwami_spheres_desc spheres;
    must(kiwami_spheres_desc_init(&spheres, sizeof spheres));
    spheres.points = points.data();
    spheres.sphere_count = what_.size;
    attach(made([&](auto geometry) {
             return kiwami_spheres_create(device_, &spheres, geometry);
           }).get());
    kiwami_discs_desc discs;
    must(kiwami_discs_desc_init(&discs, sizeof discs));
    points = points_of(what_.size + 1);
    discs.points = points.data();
    discs.normals = normals.data();
    discs.disc_count = what_.size;
    discs.mask = 5;
    attach(
        made([&](auto geometry) { return kiwami_discs_create(device_, &discs, geometry); }).get());
    kiwami_curves_desc curves;
    must(kiwami_curves_desc_init(&curves, sizeof curves));
    points = points_of(what_.size + 1);
    curves.points = points.data();
    curves.point_count = what_.size + 1;
    curves.segment_count = what_.size;
    attach(made([&](auto geometry) {
             return kiwami_curves_create(device_, &curves, geometry);
           }).get());
    points = points_of(what_.size + 1);
    curves.points = points.data();
    curves.indices = indices.data();
    attach(made([&](auto geometry) {
             return kiwami_curves_create(device_, &curves, geometry);
           }).get());
  }

  void add_moving(uint32_t step_count, float begin, float end, bool has_indices) {
    std::vector<float> vertices = small_triangles();
    const size_t step = vertices.size();
    for (size_t i = step; i < step * step_count; ++i) {
      vertices.push_back(vertices[i - step] + 0.1f * random_.symmetric());
    }
    const std::vector<uint32_t> indices = triangle_indices();
    kiwami_moving_mesh_desc desc;
    must(kiwami_moving_mesh_desc_init(&desc, sizeof desc));
    desc.vertices = vertices.data();
    desc.vertex_count = step / 3;
    desc.indices = has_indices ? indices.data() : nullptr;
    desc.triangle_count = what_.size;
    desc.step_count = step_count;
    desc.time_begin = begin;
    desc.time_end = end;
    desc.mask = 3;
    attach(made([&](auto geometry) {
             return kiwami_moving_mesh_create(device_, &desc, geometry);
           }).get());
  }

  /// count instances of the scenes in turn, within the cube.
  void add_instances(const std::vector<kiwami_scene*>& scenes, uint32_t count, bool has_masks) {
    std::vector<float> transforms;
    std::vector<uint32_t> indices, masks;
    for (uint32_t i = 0; i < count; ++i) {
      const float scale = 0.3f + 0.2f * random_.unit();
      for (uint32_t row = 0; row < 3; ++row) {
        for (uint32_t column = 0; column < 3; ++column) {
          transforms.push_back(row == column ? scale : 0.1f * random_.symmetric());
        }
        transforms.push_back(0.5f * random_.symmetric());
      }
      indices.push_back(i % static_cast<uint32_t>(scenes.size()));
      masks.push_back(i % 3 == 2 ? 6u : ~0u);
    }
    kiwami_instances_desc desc;
    must(kiwami_instances_desc_init(&desc, sizeof desc));
    desc.scenes = scenes.data();
    desc.scene_count = scenes.size();
    desc.scene_indices = scenes.size() > 1 ? indices.data() : nullptr;
    desc.transforms = transforms.data();
    desc.count = count;
    desc.masks = has_masks ? masks.data() : nullptr;
    attach(made([&](auto geometry) {
             return kiwami_instances_create(device_, &desc, geometry);
           }).get());
  }

  /// count instances of the scenes in turn, each going its own way within the cube.
  void add_moving_instances(const std::vector<kiwami_scene*>& scenes, uint32_t count) {
    constexpr uint32_t kStepCount = 3;
    std::vector<float> transforms;
    std::vector<uint32_t> indices, masks;
    for (uint32_t i = 0; i < count * kStepCount; ++i) {
      const float scale = 0.3f + 0.2f * random_.unit();
      for (uint32_t row = 0; row < 3; ++row) {
        for (uint32_t column = 0; column < 3; ++column) {
          transforms.push_back(row == column ? scale : 0.1f * random_.symmetric());
        }
        transforms.push_back(0.5f * random_.symmetric());
      }
    }
    for (uint32_t i = 0; i < count; ++i) {
      indices.push_back(i % static_cast<uint32_t>(scenes.size()));
      masks.push_back(i % 3 == 2 ? 6u : ~0u);
    }
    kiwami_moving_instances_desc desc = moving_desc(scenes);
    desc.scene_indices = scenes.size() > 1 ? indices.data() : nullptr;
    desc.transforms = transforms.data();
    desc.step_count = kStepCount;
    desc.count = count;
    desc.masks = masks.data();
    attach_moving(desc);
  }

  /// The same of the first scene, turning, for a part of the time.
  void add_turning_instances(const std::vector<kiwami_scene*>& scenes, uint32_t count) {
    std::vector<kiwami_quaternion_transform> transforms(size_t{2} * count);
    for (kiwami_quaternion_transform& transform : transforms) {
      const float scale = 0.3f + 0.2f * random_.unit();
      transform = {};
      transform.scale_x = transform.scale_y = transform.scale_z = scale;
      transform.skew_xy = 0.1f * random_.symmetric();
      transform.shift_z = 0.1f * random_.symmetric();
      transform.quaternion_r = 1.0f + random_.unit();
      transform.quaternion_i = random_.symmetric();
      transform.quaternion_j = random_.symmetric();
      transform.quaternion_k = random_.symmetric();
      transform.translation_x = 0.5f * random_.symmetric();
      transform.translation_y = 0.5f * random_.symmetric();
    }
    kiwami_moving_instances_desc desc = moving_desc(scenes);
    desc.format = KIWAMI_TRANSFORM_QUATERNION;
    desc.transforms = transforms.data();
    desc.step_count = 2;
    desc.count = count;
    desc.time_begin = 0.25f;
    desc.time_end = 0.75f;
    desc.mask = 7;
    attach_moving(desc);
  }

  /// All that the scene is to hold beside instances.
  void add_leaves() {
    add_mesh(true, ~0u);
    add_mesh(false, 0xF1);
    if (has(kRichShapes)) add_shapes();
    if (has(kRichMotion)) {
      add_moving(3, 0.0f, 1.0f, true);
      add_moving(2, 0.25f, 0.75f, false);
    }
  }

  SceneHandle commit() {
    if (has(kRichDisabled)) {
      add_mesh(true, 7);
      must(kiwami_scene_enable(scene_.get(), last_id_, 0));
    }
    set(KIWAMI_PARAMETER_BVH_WIDTH, what_.width);
    if (has(kRichTwoLevel)) set(KIWAMI_PARAMETER_TWO_LEVEL, 1);
    if (has(kRichRebraided)) set(KIWAMI_PARAMETER_REBRAID, KIWAMI_REBRAID_FULL);
    must(kiwami_scene_commit(scene_.get()));
    if (has(kRichDisabled)) {
      must(kiwami_scene_enable(scene_.get(), 1, 0));
      add_mesh(false, 1);
    }
    return std::move(scene_);
  }

 private:
  static kiwami_moving_instances_desc moving_desc(const std::vector<kiwami_scene*>& scenes) {
    kiwami_moving_instances_desc desc;
    must(kiwami_moving_instances_desc_init(&desc, sizeof desc));
    desc.scenes = scenes.data();
    desc.scene_count = scenes.size();
    return desc;
  }

  void attach_moving(const kiwami_moving_instances_desc& desc) {
    attach(made([&](auto geometry) {
             return kiwami_moving_instances_create(device_, &desc, geometry);
           }).get());
  }

  void set(uint32_t parameter, double value) {
    must(kiwami_scene_set_parameter(scene_.get(), parameter, value));
  }

  void attach(kiwami_geometry* geometry) {
    must(kiwami_scene_attach(scene_.get(), geometry, &last_id_));
  }

  std::vector<float> small_triangles() {
    std::vector<float> vertices;
    for (uint32_t i = 0; i < what_.size; ++i) {
      const float centre[3] = {random_.symmetric(), random_.symmetric(), random_.symmetric()};
      for (int number = 0; number < 9; ++number) {
        vertices.push_back(centre[number % 3] + 0.2f * random_.symmetric());
      }
    }
    return vertices;
  }

  /// In an order of their own.
  std::vector<uint32_t> triangle_indices() {
    std::vector<uint32_t> indices;
    for (uint32_t i = 0; i < what_.size; ++i) {
      const uint32_t first = 3 * random_.below(what_.size);
      indices.insert(indices.end(), {first, first + 1, first + 2});
    }
    return indices;
  }

  /// With small radii.
  std::vector<float> points_of(uint32_t count) {
    std::vector<float> points = symmetric_numbers(4 * count, random_);
    for (size_t i = 3; i < points.size(); i += 4) points[i] = 0.02f + 0.05f * random_.unit();
    return points;
  }

  void add_micromaps(kiwami_geometry* mesh, bool has_indices) {
    const uint32_t map_count = has_indices ? 2 : what_.size;
    std::vector<unsigned char> maps(size_t{map_count} * 4);
    for (unsigned char& byte : maps) byte = static_cast<unsigned char>(random_.bits());
    std::vector<uint32_t> indices(what_.size);
    for (uint32_t& index : indices) {
      index = random_.one_in(3) ? KIWAMI_OPACITY_ALL_OPAQUE : random_.below(map_count);
    }
    kiwami_opacity_desc desc;
    must(kiwami_opacity_desc_init(&desc, sizeof desc));
    desc.format = KIWAMI_OPACITY_4_STATES;
    desc.level = 2;
    desc.maps = maps.data();
    desc.map_count = map_count;
    desc.indices = has_indices ? indices.data() : nullptr;
    must(kiwami_triangle_mesh_set_opacity(mesh, &desc));
  }

  kiwami_device* device_;
  const RichScene& what_;
  Random random_;
  SceneHandle scene_;
  uint32_t last_id_ = 0;
};

SceneHandle make(kiwami_device* device, const RichScene& what) {
  Maker root(device, what, 1);
  SceneHandle inner, outer;
  if (root.has(kRichInstances | kRichMovingInstances)) {
    Maker child(device, what, 2);
    child.add_leaves();
    inner = child.commit();
  }
  if (root.has(kRichInstances)) {
    Maker parent(device, what, 3);
    parent.add_mesh(true, ~0u);
    parent.add_instances({inner.get()}, 2, false);
    if (root.has(kRichMovingInstances)) parent.add_turning_instances({inner.get()}, 1);
    outer = parent.commit();
  }
  root.add_leaves();
  if (root.has(kRichMovingInstances)) root.add_turning_instances({inner.get()}, 2);
  if (root.has(kRichInstances)) {
    root.add_instances({outer.get(), inner.get(), inner.get()}, 4, true);
    root.add_instances({inner.get()}, 1, false);
  }
  if (root.has(kRichMovingInstances)) {
    kiwami_scene* const other = outer ? outer.get() : inner.get();
    root.add_moving_instances({inner.get(), other}, 3);
  }
  return root.commit();
}

}  // namespace

kiwami_result make_rich_scene(kiwami_device* device, const RichScene& what, kiwami_scene** scene) {
  *scene = nullptr;
  try {
    *scene = make(device, what).release();
  } catch (const Failure& failure) {
    return failure.result;
  }
  return KIWAMI_OK;
}

}  // namespace kiwami_tests
