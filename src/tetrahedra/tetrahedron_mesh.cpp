// SPDX-License-Identifier: Apache-2.0
#include "tetrahedra/tetrahedron_mesh.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include "core/error.h"
#include "core/strided_buffer.h"
#include "math/float_environment.h"
#include "tetrahedra/volume.h"

namespace kiwami {
namespace {

/// Points that one task locates; fewer than two tasks stay on the calling thread.
constexpr size_t kBlockSize = 4096;

constexpr kiwami_tetrahedron_location kNowhere{KIWAMI_INVALID_ID, {0.0f, 0.0f, 0.0f, 0.0f}};

/// Throws for the first tetrahedron that has an index of no vertex.
void check_indices(const Array<Tetrahedron>& tetrahedra, size_t vertex_count) {
  for (size_t i = 0; i < tetrahedra.size(); ++i) {
    for (int k = 0; k < 4; ++k) {
      if (tetrahedra[i].vertex[k] < vertex_count) continue;
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "index %d of tetrahedron %zu is %u, expected below the vertex count, %zu", k, i,
                  tetrahedra[i].vertex[k], vertex_count);
    }
  }
}

bool is_in_range(const Vec3f (&corner)[4]) {
  for (const Vec3f& at : corner) {
    for (int axis = 0; axis < 3; ++axis) {
      // A comparison with NaN is false.
      if (!(std::fabs(at[axis]) <= KIWAMI_MAX_COORDINATE)) return false;
    }
  }
  return true;
}

TetrahedronSource read_source(const TetrahedronInput& input, Device& device) {
  Memory& memory = device.memory();
  TetrahedronSource source;
  source.vertices = Array<Vec3f>(memory, input.vertex_count);
  pack(input.vertices, input.vertex_stride, input.vertex_count, sizeof(Vec3f),
       reinterpret_cast<unsigned char*>(source.vertices.data()), device);
  source.tetrahedra = Array<Tetrahedron>(memory, input.tetrahedron_count);
  pack(input.indices, input.index_stride, input.tetrahedron_count, sizeof(Tetrahedron),
       reinterpret_cast<unsigned char*>(source.tetrahedra.data()), device);
  check_indices(source.tetrahedra, input.vertex_count);
  source.has_volume = Array<uint8_t>(memory, input.tetrahedron_count);
  Array<uint8_t> is_inverted(memory, input.tetrahedron_count);
  device.parallel().for_blocks(input.tetrahedron_count, kBlockSize, [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      Vec3f corner[4];
      source.corners_of(static_cast<uint32_t>(i), corner);
      const double volume =
          is_in_range(corner) ? signed_volume(corner[0], corner[1], corner[2], corner[3]) : 0.0;
      source.has_volume[i] = volume != 0.0 ? 1 : 0;
      is_inverted[i] = volume < 0.0 ? 1 : 0;
    }
  });
  for (size_t i = 0; i < input.tetrahedron_count; ++i) {
    source.skipped_count += source.has_volume[i] == 0 ? 1 : 0;
    source.inverted_count += is_inverted[i];
  }
  return source;
}

}  // namespace

TetrahedronMesh* TetrahedronMesh::create(Device& device, const TetrahedronInput& input) {
  const DefaultFloatEnvironment environment;
  return make_object<TetrahedronMesh>(device.memory(), device, input);
}

void TetrahedronMesh::destroy(TetrahedronMesh* mesh) noexcept {
  const Reference<Device> device = mesh->device_;
  destroy_object(device->memory(), mesh);
}

TetrahedronMesh::TetrahedronMesh(Device& device, const TetrahedronInput& input)
    : device_(device), method_(input.method) {
  const auto start = std::chrono::steady_clock::now();
  source_ = read_source(input, device);
  tree_ = TetrahedronTree(source_, device.memory(), device.parallel());
  if (method_ == KIWAMI_TETRAHEDRA_FACES) faces_ = FaceTracer(source_, device);
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  build_seconds_ = seconds.count();
}

kiwami_tetrahedra_info TetrahedronMesh::info() const {
  kiwami_tetrahedra_info info{};
  info.method = method_;
  info.tetrahedron_count = source_.tetrahedra.size();
  info.skipped_count = source_.skipped_count;
  info.inverted_count = source_.inverted_count;
  const FaceTracer::Counts& counts = faces_.counts();
  info.face_count = counts.faces;
  info.boundary_face_count = counts.boundary_faces;
  info.crowded_face_count = counts.crowded_faces;
  info.bytes = sizeof *this + source_.vertices.bytes() + source_.tetrahedra.bytes() +
               source_.has_volume.bytes() + tree_.bytes() + faces_.bytes();
  info.build_seconds = build_seconds_;
  return info;
}

kiwami_tetrahedron_location TetrahedronMesh::locate_in_boxes(const Vec3f& point) const {
  kiwami_tetrahedron_location found = kNowhere;
  tree_.visit_boxes_at(point, [&](uint32_t id) {
    // Another one on whose border the point lies matters only if its number is lower.
    if (id > found.tetrahedron_id) return true;
    Vec3f corner[4];
    source_.corners_of(id, corner);
    float weights[4];
    const PointPlace place = place_point(corner, point, weights);
    if (place == PointPlace::kOutside) return true;
    found.tetrahedron_id = id;
    std::copy_n(weights, 4, found.weights);
    return place == PointPlace::kOnBorder;
  });
  return found;
}

void TetrahedronMesh::locate_block(const LocationBatch& batch) const {
  constexpr size_t kMostPoints = FaceTracer::kMostPoints;
  for (size_t first = 0; first < batch.count; first += kMostPoints) {
    const size_t count = std::min(kMostPoints, batch.count - first);
    Vec3f points[kMostPoints];
    uint32_t candidates[kMostPoints];
    for (size_t i = 0; i < count; ++i) {
      std::memcpy(&points[i], batch.points + (first + i) * batch.point_stride, sizeof(Vec3f));
      candidates[i] = KIWAMI_INVALID_ID;
    }
    if (method_ == KIWAMI_TETRAHEDRA_FACES) faces_.find_candidates(points, count, candidates);
    for (size_t i = 0; i < count; ++i) {
      kiwami_tetrahedron_location location{candidates[i], {}};
      bool is_found = false;
      if (candidates[i] != KIWAMI_INVALID_ID) {
        Vec3f corner[4];
        source_.corners_of(candidates[i], corner);
        is_found = place_point(corner, points[i], location.weights) == PointPlace::kInside;
      }
      if (!is_found) location = locate_in_boxes(points[i]);
      std::memcpy(batch.locations + (first + i) * batch.location_stride, &location,
                  sizeof location);
    }
  }
}

void TetrahedronMesh::locate(const LocationBatch& batch) const {
  const Parallel& parallel = device_->parallel();
  if (batch.count < 2 * kBlockSize || parallel.width() == 1) {
    const DefaultFloatEnvironment environment;
    return locate_block(batch);
  }
  parallel.for_blocks(batch.count, kBlockSize, [&](size_t begin, size_t end) {
    LocationBatch block = batch;
    block.points += begin * batch.point_stride;
    block.locations += begin * batch.location_stride;
    block.count = end - begin;
    locate_block(block);
  });
}

}  // namespace kiwami
