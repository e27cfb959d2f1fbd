// SPDX-License-Identifier: Apache-2.0
#include "tetrahedra/face_tracer.h"

#include <algorithm>
#include <cmath>

#include "core/trace.h"
#include "core/triangle_mesh.h"
#include "parallel/radix_sort.h"
#include "tetrahedra/volume.h"

namespace kiwami {
namespace {

constexpr size_t kBlockSize = 8192;

/// Of rays: of length 1, along no axis, plane or diagonal that meshes are likely to have.
constexpr Vec3f kDirection{0.736f, 0.544f, 0.403f};

/// A face of one tetrahedron, its vertices by rising number.
struct Face {
  uint32_t vertex[3];
  uint32_t tetrahedron;
  bool is_above;  ///< whether the tetrahedron is on the side of the normal

  bool has_vertices_of(const Face& other) const {
    return std::equal(vertex, vertex + 3, other.vertex);
  }
};

Face face_opposite(const TetrahedronSource& source, uint32_t id, uint32_t corner) {
  Face face{{}, id, false};
  uint32_t count = 0;
  for (uint32_t i = 0; i < 4; ++i) {
    if (i != corner) face.vertex[count++] = source.tetrahedra[id].vertex[i];
  }
  std::sort(face.vertex, face.vertex + 3);
  face.is_above = signed_volume(source.vertices[face.vertex[0]], source.vertices[face.vertex[1]],
                                source.vertices[face.vertex[2]],
                                source.vertices[source.tetrahedra[id].vertex[corner]]) > 0.0;
  return face;
}

/// All faces of all tetrahedra that have a volume, equal ones next to each other, by rising
/// tetrahedron.
Array<Face> sorted_faces(const TetrahedronSource& source, Memory& memory,
                         const Parallel& parallel) {
  Array<uint32_t> ids(memory, source.tetrahedra.size() - source.skipped_count);
  size_t count = 0;
  for (uint32_t id = 0; id < source.tetrahedra.size(); ++id) {
    if (source.has_volume[id] != 0) ids[count++] = id;
  }
  Array<Face> faces(memory, 4 * ids.size());
  parallel.for_blocks(ids.size(), kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      for (uint32_t corner = 0; corner < 4; ++corner) {
        faces[4 * i + corner] = face_opposite(source, ids[i], corner);
      }
    }
  });
  uint32_t key_bits = 1;
  while (source.vertices.size() >> key_bits != 0) ++key_bits;
  for (int i = 3; i-- > 0;) {
    radix_sort(
        faces, key_bits, [i](const Face& face) { return face.vertex[i]; }, memory, parallel);
  }
  return faces;
}

/// The length of the longest edge, rounded up.
float longest_edge(const TetrahedronSource& source) {
  double greatest = 0.0;
  for (uint32_t id = 0; id < source.tetrahedra.size(); ++id) {
    if (source.has_volume[id] == 0) continue;
    Vec3f corner[4];
    source.corners_of(id, corner);
    for (int i = 0; i < 4; ++i) {
      for (int j = 0; j < i; ++j) {
        double square = 0.0;
        for (int axis = 0; axis < 3; ++axis) {
          const double along =
              static_cast<double>(corner[i][axis]) - static_cast<double>(corner[j][axis]);
          square += along * along;
        }
        greatest = std::max(greatest, square);
      }
    }
  }
  return static_cast<float>(std::sqrt(greatest) * 1.0001);
}

}  // namespace

FaceTracer::FaceTracer(const TetrahedronSource& source, Device& device)
    : reach_(longest_edge(source)) {
  Memory& memory = device.memory();
  const Array<Face> faces = sorted_faces(source, memory, device.parallel());
  size_t count = 0;
  for (size_t i = 0; i < faces.size(); ++i) {
    if (i == 0 || !faces[i].has_vertices_of(faces[i - 1])) ++count;
  }
  Array<uint32_t> indices(memory, 3 * count);
  sides_ = Array<Sides>(memory, count);
  counts_ = {count, 0, 0};
  size_t next = 0;
  for (size_t i = 0; i < faces.size();) {
    Sides sides{KIWAMI_INVALID_ID, KIWAMI_INVALID_ID};
    size_t end = i;
    bool is_crowded = false;
    for (; end < faces.size() && faces[end].has_vertices_of(faces[i]); ++end) {
      uint32_t& side = faces[end].is_above ? sides.above : sides.below;
      is_crowded = is_crowded || side != KIWAMI_INVALID_ID;
      if (side == KIWAMI_INVALID_ID) side = faces[end].tetrahedron;
    }
    if (end == i + 1) ++counts_.boundary_faces;
    if (is_crowded) ++counts_.crowded_faces;
    std::copy_n(faces[i].vertex, 3, &indices[3 * next]);
    sides_[next++] = sides;
    i = end;
  }
  kiwami_triangle_mesh_desc desc{};
  desc.struct_size = sizeof desc;
  desc.vertices = source.vertices.data();
  desc.vertex_count = source.vertices.size();
  desc.indices = indices.data();
  desc.triangle_count = count;
  desc.mask = ~uint32_t{0};
  scene_ = Reference<Scene>::adopt(Scene::create(device));
  const auto mesh = Reference<TriangleMesh>::adopt(TriangleMesh::create(device, desc));
  scene_->attach(*mesh);
  scene_->commit();
}

uint64_t FaceTracer::bytes() const {
  return sides_.bytes() + (scene_.get() ? scene_->committed()->info().total_bytes : 0);
}

void FaceTracer::find_candidates(const Vec3f* points, size_t count, uint32_t* ids) const {
  kiwami_ray rays[kMostPoints];
  kiwami_hit hits[kMostPoints];
  for (size_t i = 0; i < count; ++i) {
    rays[i] = {points[i].x,
               points[i].y,
               points[i].z,
               0.0f,
               kDirection.x,
               kDirection.y,
               kDirection.z,
               reach_,
               0.0f,
               ~uint32_t{0},
               0,
               0};
  }
  kClosestHit.answer(*scene_->committed(),
                     {reinterpret_cast<const unsigned char*>(rays), sizeof(kiwami_ray),
                      reinterpret_cast<unsigned char*>(hits), sizeof(kiwami_hit), count},
                     QueryOptions{});
  for (size_t i = 0; i < count; ++i) {
    ids[i] = KIWAMI_INVALID_ID;
    if (hits[i].geometry_id == KIWAMI_INVALID_ID) continue;
    const double along = static_cast<double>(hits[i].normal_x) * static_cast<double>(kDirection.x) +
                         static_cast<double>(hits[i].normal_y) * static_cast<double>(kDirection.y) +
                         static_cast<double>(hits[i].normal_z) * static_cast<double>(kDirection.z);
    const Sides sides = sides_[hits[i].primitive_id];
    ids[i] = along < 0.0 ? sides.above : sides.below;
  }
}

}  // namespace kiwami
