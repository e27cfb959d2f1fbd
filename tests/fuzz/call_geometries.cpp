// SPDX-License-Identifier: Apache-2.0
#include "fuzz/call_geometries.h"

namespace kiwami_fuzz {
namespace {

template <typename Desc>
Geometry created_by(kiwami_result (*create)(kiwami_device*, const Desc*, kiwami_geometry**),
                    kiwami_device* device, const Desc* desc) {
  kiwami_geometry* made = nullptr;
  const kiwami_result result = check(create(device, desc, &made));
  require((result == KIWAMI_OK) == (made != nullptr), "a geometry and an error");
  return Geometry(made);
}

/// Makes one field impossible, in a way that must be found before anything is read.
void spoil(Arguments& arguments, kiwami_triangle_mesh_desc& desc) {
  switch (arguments.below(8)) {
    case 0:
      desc.struct_size = arguments.whole() % 8;
      break;
    case 1:
      desc.flags = 0x80u;
      break;
    case 2:
      desc.vertex_count = uint64_t{1} << (33 + arguments.below(30));
      break;
    case 3:
      desc.triangle_count = arguments.huge();
      break;
    case 4:
      desc.vertex_stride = 1 + arguments.below(11);
      break;
    case 5:
      desc.reserved = 1;
      break;
    case 6:
      desc.vertices = nullptr;
      desc.vertex_count = 1;
      break;
    default:
      desc.vertex_stride = UINT64_MAX - 3;
      desc.vertex_count = 3;
      break;
  }
}

Geometry make_spheres(Arguments& arguments, kiwami_device* device) {
  const size_t count = arguments.below(kMostElements);
  const std::vector<float> points = arguments.numbers(4 * count);
  kiwami_spheres_desc desc;
  check(kiwami_spheres_desc_init(&desc, sizeof desc));
  desc.points = points.data();
  desc.sphere_count = count;
  if (arguments.rarely()) desc.point_stride = 1 + arguments.below(15);
  if (arguments.rarely()) desc.struct_size = arguments.wrong_size(sizeof desc);
  if (arguments.rarely()) desc.sphere_count = arguments.huge();
  return created_by(kiwami_spheres_create, device, &desc);
}

Geometry make_discs(Arguments& arguments, kiwami_device* device) {
  const size_t count = arguments.below(kMostElements);
  const std::vector<float> points = arguments.numbers(4 * count);
  const std::vector<float> normals = arguments.numbers(3 * count);
  kiwami_discs_desc desc;
  check(kiwami_discs_desc_init(&desc, sizeof desc));
  desc.points = points.data();
  desc.normals = arguments.rarely() ? nullptr : normals.data();
  desc.disc_count = count;
  if (arguments.rarely()) desc.normal_stride = 1 + arguments.below(11);
  if (arguments.rarely()) desc.disc_count = arguments.huge();
  return created_by(kiwami_discs_create, device, &desc);
}

Geometry make_curves(Arguments& arguments, kiwami_device* device) {
  const uint32_t count = 1 + arguments.below(kMostElements);
  const std::vector<float> points = arguments.numbers(size_t{4} * count);
  const std::vector<uint32_t> indices = arguments.indices(arguments.below(kMostElements), count);
  kiwami_curves_desc desc;
  check(kiwami_curves_desc_init(&desc, sizeof desc));
  desc.points = points.data();
  desc.point_count = count;
  desc.segment_count = count - 1;
  if (arguments.below(2) == 0) {
    desc.indices = indices.data();
    desc.segment_count = indices.size();
  }
  if (arguments.rarely()) desc.segment_count = arguments.huge();
  return created_by(kiwami_curves_create, device, &desc);
}

/// What the callbacks of a user geometry answer by.
struct Whim {
  float numbers[8];
  uint32_t bits;
};

int32_t bound(void* user, uint32_t first, uint32_t count, float* bounds) {
  const Whim& whim = *static_cast<const Whim*>(user);
  for (uint32_t i = 0; i < 6 * count; ++i) bounds[i] = whim.numbers[(6 * first + i) % 7];
  return (whim.bits & 0xF0) == 0 ? -1 : 0;
}

int32_t intersect(void* user, kiwami_user_intersection* intersection) {
  const Whim& whim = *static_cast<const Whim*>(user);
  const uint32_t count = whim.bits % (intersection->hit_capacity + 1);
  for (uint32_t i = 0; i < count; ++i) {
    const uint32_t id = intersection->primitive_ids[i % intersection->primitive_count];
    const auto number = [&](uint32_t k) { return whim.numbers[(id + i + k) % 8]; };
    intersection->hits[i] = {number(0), number(1), number(2), number(3),
                             number(4), number(5), id,        0};
  }
  intersection->hit_count = count;
  // Lies of which a library can see that they are some.
  if ((whim.bits & 0xF00) == 0) intersection->hit_count = ~0u;
  if ((whim.bits & 0xF000) == 0 && count != 0) intersection->hits[0].primitive_id = whim.bits;
  return (whim.bits & 0xF0000) == 0 ? -1 : 0;
}

Geometry make_moving_instances(Arguments& arguments, kiwami_device* device, kiwami_scene* scene) {
  const uint32_t count = 1 + arguments.below(6), steps = 2 + arguments.below(3);
  const uint32_t format = arguments.rarely() ? arguments.whole() : arguments.below(2);
  const std::vector<float> transforms = arguments.numbers(size_t{16} * count * steps);
  kiwami_moving_instances_desc desc;
  check(kiwami_moving_instances_desc_init(&desc, sizeof desc));
  desc.scenes = &scene;
  desc.scene_count = 1;
  desc.transforms = transforms.data();
  desc.count = count;
  desc.format = format;
  desc.step_count = arguments.rarely() ? arguments.below(2) : steps;
  if (arguments.rarely()) desc.time_end = arguments.number();
  if (arguments.rarely()) desc.step_stride = arguments.below(48);
  if (arguments.rarely()) desc.count = arguments.huge();
  return created_by(kiwami_moving_instances_create, device, &desc);
}

/// Mostly ones that a ray can be carried by.
std::vector<float> make_matrices(Arguments& arguments, uint32_t count) {
  std::vector<float> matrices;
  for (uint32_t i = 0; i < count; ++i) {
    const std::vector<float> numbers = arguments.numbers(12);
    matrices.insert(matrices.end(), numbers.begin(), numbers.end());
    if (arguments.rarely()) continue;
    float* const matrix = &matrices[size_t{12} * i];
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column) matrix[4 * row + column] = row == column ? 1 : 0;
    }
  }
  return matrices;
}

}  // namespace

Geometry make_mesh(Arguments& arguments, kiwami_device* device) {
  const uint32_t triangles = arguments.below(kMostElements);
  const size_t stride = 12 + arguments.below(5);
  const size_t vertices = 3 * size_t{triangles};
  // Buffers of just the size that is described.
  const std::vector<float> corners = arguments.numbers(3 * vertices);
  std::vector<unsigned char> bytes(vertices == 0 ? 0 : (vertices - 1) * stride + 12);
  for (size_t i = 0; i < vertices; ++i) {
    std::memcpy(bytes.data() + i * stride, corners.data() + 3 * i, 12);
  }
  const std::vector<uint32_t> indices = arguments.indices(vertices, 3 * triangles + 1);
  kiwami_triangle_mesh_desc desc;
  check(kiwami_triangle_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = bytes.data();
  desc.vertex_count = vertices;
  desc.vertex_stride = stride;
  desc.triangle_count = triangles;
  desc.mask = arguments.rarely() ? arguments.whole() : ~0u;
  if (arguments.below(2) == 0) desc.indices = indices.data();
  if (arguments.rarely()) spoil(arguments, desc);
  return created_by(kiwami_triangle_mesh_create, device, arguments.rarely() ? nullptr : &desc);
}

Geometry make_moving_mesh(Arguments& arguments, kiwami_device* device) {
  const uint32_t triangles = arguments.below(kMostElements / 4), steps = 2 + arguments.below(4);
  const size_t vertices = 3 * size_t{triangles};
  const std::vector<float> corners = arguments.numbers(3 * vertices * steps);
  const std::vector<uint32_t> indices = arguments.indices(vertices, 3 * triangles + 1);
  kiwami_moving_mesh_desc desc;
  check(kiwami_moving_mesh_desc_init(&desc, sizeof desc));
  desc.vertices = corners.data();
  desc.vertex_count = vertices;
  desc.triangle_count = triangles;
  desc.step_count = arguments.rarely() ? arguments.below(2) : steps;
  if (arguments.below(2) == 0) desc.indices = indices.data();
  if (arguments.rarely()) desc.time_begin = arguments.number();
  if (arguments.rarely()) desc.vertex_stride = 1 + arguments.below(11);
  if (arguments.rarely()) desc.triangle_count = arguments.huge();
  return created_by(kiwami_moving_mesh_create, device, &desc);
}

Geometry make_shapes(Arguments& arguments, kiwami_device* device) {
  switch (arguments.below(3)) {
    case 0:
      return make_spheres(arguments, device);
    case 1:
      return make_discs(arguments, device);
    default:
      return make_curves(arguments, device);
  }
}

Geometry make_user_geometry(Arguments& arguments, kiwami_device* device) {
  auto whim = std::make_unique<Whim>();
  for (float& number : whim->numbers) number = arguments.number();
  whim->bits = arguments.bits();
  kiwami_user_geometry_desc desc;
  check(kiwami_user_geometry_desc_init(&desc, sizeof desc));
  desc.count = arguments.below(kMostElements);
  desc.bounds = arguments.rarely() ? nullptr : bound;
  desc.intersect = arguments.rarely() ? nullptr : intersect;
  desc.destroy = [](void* user) { delete static_cast<Whim*>(user); };
  desc.user = whim.get();
  if (arguments.rarely()) desc.count = arguments.huge();
  Geometry made = created_by(kiwami_user_geometry_create, device, &desc);
  if (made) whim.release();
  return made;
}

Geometry make_instances(Arguments& arguments, kiwami_device* device, kiwami_scene* scene) {
  if (arguments.below(3) == 0) return make_moving_instances(arguments, device, scene);
  const uint32_t count = 1 + arguments.below(6);
  const std::vector<float> transforms = make_matrices(arguments, count);
  const std::vector<uint32_t> scene_indices = arguments.indices(count, 1);
  kiwami_instances_desc desc;
  check(kiwami_instances_desc_init(&desc, sizeof desc));
  desc.scenes = &scene;
  desc.scene_count = 1;
  desc.transforms = transforms.data();
  desc.count = count;
  if (arguments.below(2) == 0) desc.scene_indices = scene_indices.data();
  if (arguments.rarely()) desc.mask = arguments.whole();
  if (arguments.rarely()) desc.transform_stride = 1 + arguments.below(47);
  if (arguments.rarely()) desc.count = arguments.huge();
  return created_by(kiwami_instances_create, device, &desc);
}

void set_opacity(Arguments& arguments, kiwami_geometry* mesh) {
  const uint32_t level = arguments.below(4), format = 1 + arguments.below(2);
  const size_t size = (size_t{format} << (2 * level)) / 8 + 1;
  std::vector<unsigned char> maps(size * kMostElements);
  for (unsigned char& byte : maps) byte = static_cast<unsigned char>(arguments.below(256));
  // As many as a mesh of these calls can have triangles, so that none reads beyond.
  std::vector<uint32_t> indices = arguments.indices(kMostElements, kMostElements);
  for (uint32_t& index : indices) index -= arguments.below(3) == 0 ? kMostElements : 0;
  kiwami_opacity_desc desc;
  check(kiwami_opacity_desc_init(&desc, sizeof desc));
  desc.format = arguments.rarely() ? arguments.whole() : format;
  desc.level = arguments.rarely() ? 7 + arguments.whole() % 1000 : level;
  desc.maps = maps.data();
  desc.map_stride = size;
  desc.map_count = kMostElements;
  desc.indices = arguments.below(2) == 0 ? indices.data() : nullptr;
  if (arguments.rarely()) desc.map_count = arguments.huge();
  check(kiwami_triangle_mesh_set_opacity(mesh, arguments.below(4) == 0 ? nullptr : &desc));
}

}  // namespace kiwami_fuzz
