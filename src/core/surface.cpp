// SPDX-License-Identifier: Apache-2.0
#include "core/surface.h"

#include <cstring>
#include <limits>

#include "core/error.h"
#include "core/trace.h"
#include "math/float_environment.h"
#include "math/hit_point.h"

namespace kiwami {
namespace {

/// Elements that one task takes.
constexpr size_t kBlockSize = 4096;

/// Calls body(i) for all of count elements, on the device's threads if they are many.
template <typename Body>
void for_elements(const Parallel& parallel, size_t count, Body body) {
  const auto run = [&](size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) body(i);
  };
  if (is_alone(parallel, count, false)) {
    const DefaultFloatEnvironment environment;
    run(0, count);
  } else {
    parallel.for_blocks(count, kBlockSize, run);
  }
}

void write_vector(const VectorRun& run, size_t i, Vec3f value) {
  if (run.data) std::memcpy(run.data + i * run.stride, &value, sizeof value);
}

constexpr float kNaN = std::numeric_limits<float>::quiet_NaN();
constexpr Vec3f kNowhere = {kNaN, kNaN, kNaN};

/// The triangles that hits are on.
class HitTriangles {
 public:
  HitTriangles(const CommittedScene& scene, const HitRun& hits)
      : source_(scene.source()), hits_(hits) {}

  /// Returns false for a miss.
  bool read(size_t i, kiwami_hit& hit, Vec3f corner[3]) const {
    std::memcpy(&hit, hits_.hits + i * hits_.stride, sizeof hit);
    if (hit.primitive_id == KIWAMI_INVALID_ID) return false;
    if (hit.instance_id != KIWAMI_INVALID_ID) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "hits[%zu].instance_id is %u, expected a hit outside of instances", i,
                  hit.instance_id);
    }
    const TriangleMeshView& mesh = mesh_of(i, hit.geometry_id);
    if (hit.primitive_id >= mesh.triangle_count) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "hits[%zu].primitive_id is %u, expected below the %u triangles of geometry %u", i,
                  hit.primitive_id, mesh.triangle_count, hit.geometry_id);
    }
    mesh.corners_of(hit.primitive_id, corner);
    return true;
  }

 private:
  /// Meshes come by rising geometry_id.
  const TriangleMeshView& mesh_of(size_t i, uint32_t geometry_id) const {
    uint32_t low = 0, high = source_.mesh_count;
    while (low < high) {
      const uint32_t middle = low + (high - low) / 2;
      if (source_.meshes[middle].geometry_id < geometry_id) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    if (low == source_.mesh_count || source_.meshes[low].geometry_id != geometry_id) {
      throw Error(
          KIWAMI_ERROR_INVALID_ARGUMENT,
          "hits[%zu].geometry_id is %u, expected the number of a triangle mesh of the scene", i,
          geometry_id);
    }
    return source_.meshes[low];
  }

  TriangleSource source_;
  HitRun hits_;
};

template <typename T>
T read_element(const kiwami_input_field& field, size_t i) {
  T value;
  std::memcpy(&value,
              static_cast<const unsigned char*>(field.data) + i * static_cast<size_t>(field.stride),
              sizeof value);
  return value;
}

/// One interpolation of many elements.
class Interpolator {
 public:
  Interpolator(const TriangleMesh& mesh, const kiwami_interpolation& desc)
      : mesh_(mesh.view(0, 0)),
        desc_(desc),
        attributes_(static_cast<const unsigned char*>(desc.attributes) + desc.attribute_offset),
        indices_(static_cast<const unsigned char*>(desc.indices) + desc.index_offset) {}

  void run(size_t i) const {
    if (desc_.geometry_id.data && read_element<uint32_t>(desc_.geometry_id, i) != desc_.geometry) {
      return;
    }
    const auto primitive = read_element<uint32_t>(desc_.primitive_id, i);
    if (primitive == KIWAMI_INVALID_ID) {
      for (uint32_t channel = 0; channel < desc_.channels; ++channel) write(i, channel, 0, 0, 0);
      return;
    }
    if (primitive >= mesh_.triangle_count) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "element %zu of primitive_id is %u, expected below the %u triangles of the mesh",
                  i, primitive, mesh_.triangle_count);
    }
    uint32_t index[3];
    find_attributes(primitive, index);
    const auto u = read_element<float>(desc_.u, i), v = read_element<float>(desc_.v, i);
    const float w = (1.0f - u) - v;
    for (uint32_t channel = 0; channel < desc_.channels; ++channel) {
      const float a = attribute(index[0], channel), b = attribute(index[1], channel),
                  c = attribute(index[2], channel);
      write(i, channel, (w * a + u * b) + v * c, b - a, c - a);
    }
  }

 private:
  void find_attributes(uint32_t primitive, uint32_t index[3]) const {
    if (desc_.indices) {
      std::memcpy(index, indices_ + primitive * static_cast<size_t>(desc_.index_stride),
                  3 * sizeof(uint32_t));
    } else {
      mesh_.indices_of(primitive, index);
    }
    for (int k = 0; k < 3; ++k) {
      if (index[k] < desc_.attribute_count) continue;
      throw Error(
          KIWAMI_ERROR_INVALID_ARGUMENT,
          "corner %d of triangle %u has attribute %u, expected below the attribute_count of "
          "%llu",
          k, primitive, index[k], static_cast<unsigned long long>(desc_.attribute_count));
    }
  }

  float attribute(uint32_t index, uint32_t channel) const {
    float value;
    std::memcpy(
        &value,
        attributes_ + index * static_cast<size_t>(desc_.attribute_stride) + channel * sizeof(float),
        sizeof value);
    return value;
  }

  void write(size_t i, uint32_t channel, float value, float by_u, float by_v) const {
    put(desc_.values, desc_.value_stride, i, channel, value);
    put(desc_.derivatives_u, desc_.derivative_u_stride, i, channel, by_u);
    put(desc_.derivatives_v, desc_.derivative_v_stride, i, channel, by_v);
  }

  static void put(void* target, uint64_t stride, size_t i, uint32_t channel, float value) {
    if (!target) return;
    std::memcpy(static_cast<unsigned char*>(target) + i * static_cast<size_t>(stride) +
                    channel * sizeof(float),
                &value, sizeof value);
  }

  TriangleMeshView mesh_;
  const kiwami_interpolation& desc_;
  const unsigned char* attributes_;
  const unsigned char* indices_;
};

}  // namespace

void find_hit_points(const CommittedScene& scene, const HitRun& hits, const VectorRun& points,
                     const VectorRun& errors) {
  const HitTriangles triangles(scene, hits);
  for_elements(scene.parallel(), hits.count, [&](size_t i) {
    kiwami_hit hit;
    Vec3f corner[3];
    if (!triangles.read(i, hit, corner)) {
      write_vector(points, i, kNowhere);
      write_vector(errors, i, kNowhere);
      return;
    }
    const HitPoint point(corner, hit.u, hit.v);
    write_vector(points, i, point.rounded());
    write_vector(errors, i, point.error());
  });
}

void find_offset_origins(const CommittedScene& scene, const HitRun& hits,
                         const unsigned char* directions, size_t direction_stride,
                         const VectorRun& origins) {
  const HitTriangles triangles(scene, hits);
  for_elements(scene.parallel(), hits.count, [&](size_t i) {
    kiwami_hit hit;
    Vec3f corner[3], direction;
    if (!triangles.read(i, hit, corner)) {
      write_vector(origins, i, kNowhere);
      return;
    }
    std::memcpy(&direction, directions + i * direction_stride, sizeof direction);
    write_vector(origins, i, offset_origin(corner, hit.u, hit.v, direction));
  });
}

void interpolate(const TriangleMesh& mesh, const kiwami_interpolation& interpolation,
                 size_t count) {
  const Interpolator interpolator(mesh, interpolation);
  for_elements(mesh.device().parallel(), count, [&](size_t i) { interpolator.run(i); });
}

}  // namespace kiwami
