// SPDX-License-Identifier: Apache-2.0
//
// Kiwami for C++20: the kinds of geometries that are arrays of numbers. Use kiwami.hpp.
#ifndef KIWAMI_GEOMETRIES_HPP
#define KIWAMI_GEOMETRIES_HPP

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include "handles.hpp"

namespace kiwami {

/// Only rays with (ray.mask & mask) != 0 meet a geometry; by default all do.
inline constexpr std::uint32_t kAllMasks = ~std::uint32_t{0};

/// Centre and radius: a sphere, or a point of a curve.
using Sphere = std::array<float, 4>;

namespace detail {

inline void require_equal(std::size_t found, std::size_t expected, const char* what) {
  if (found == expected) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, std::string(what) + " has size " +
                                                 std::to_string(found) + ", expected " +
                                                 std::to_string(expected));
}

/// A descriptor with the library's defaults.
template <typename Desc>
Desc defaults(kiwami_result (*init)(Desc*, std::size_t)) {
  Desc desc;
  check(init(&desc, sizeof(desc)));
  return desc;
}

template <typename Desc>
kiwami_geometry* create_geometry(const Device& device, const Desc& desc,
                                 kiwami_result (*create)(kiwami_device*, const Desc*,
                                                         kiwami_geometry**)) {
  kiwami_geometry* geometry = nullptr;
  check(create(device.get(), &desc, &geometry), device.get());
  return geometry;
}

/// An empty span may be a null pointer, which stands for triangles without indices.
inline const void* indices_of(std::span<const Triangle> triangles) {
  static constexpr Triangle kNone{};
  return triangles.empty() ? &kNone : triangles.data();
}

}  // namespace detail

/// A triangle mesh.
class Mesh : public Geometry {
 public:
  /// Copies vertices and triangles.
  Mesh(const Device& device, std::span<const Vertex> vertices, std::span<const Triangle> triangles,
       std::uint32_t mask = kAllMasks)
      : Geometry(create(device, vertices, triangles, mask)),
        device_(device),
        vertex_count_(vertices.size()) {}
  /// With strides, offsets and shared buffers as the C interface has them.
  Mesh(const Device& device, const kiwami_triangle_mesh_desc& desc)
      : Geometry(detail::create_geometry(device, desc, kiwami_triangle_mesh_create)),
        device_(device),
        vertex_count_(static_cast<std::size_t>(desc.vertex_count)) {}

  /// Gives the mesh other vertices, as many as it has; they show with the next commit or refit of
  /// its scenes. Meshes that share the caller's buffers keep the span.
  void update_vertices(std::span<const Vertex> vertices) {
    detail::require_equal(vertices.size(), vertex_count_, "vertices");
    detail::check(kiwami_triangle_mesh_update_vertices(get(), vertices.data(), 0, 0),
                  device_.get());
  }

 private:
  static kiwami_geometry* create(const Device& device, std::span<const Vertex> vertices,
                                 std::span<const Triangle> triangles, std::uint32_t mask) {
    auto desc = detail::defaults(kiwami_triangle_mesh_desc_init);
    desc.vertices = vertices.data();
    desc.vertex_count = vertices.size();
    desc.indices = detail::indices_of(triangles);
    desc.triangle_count = triangles.size();
    desc.mask = mask;
    return detail::create_geometry(device, desc, kiwami_triangle_mesh_create);
  }

  Device device_;
  std::size_t vertex_count_;
};

/// When a moving mesh is where its first and its last step say.
struct TimeRange {
  float begin = 0.0f;
  float end = 1.0f;
};

/// A triangle mesh whose vertices move from step to step.
class MovingMesh : public Geometry {
 public:
  /// Copies the vertices of all steps, one step after the other, and the triangles.
  MovingMesh(const Device& device, std::span<const Vertex> vertices, std::uint32_t step_count,
             std::span<const Triangle> triangles, TimeRange times = {},
             std::uint32_t mask = kAllMasks)
      : Geometry(create(device, vertices, step_count, triangles, times, mask)) {}
  /// As the C interface has it.
  MovingMesh(const Device& device, const kiwami_moving_mesh_desc& desc)
      : Geometry(detail::create_geometry(device, desc, kiwami_moving_mesh_create)) {}

 private:
  static kiwami_geometry* create(const Device& device, std::span<const Vertex> vertices,
                                 std::uint32_t step_count, std::span<const Triangle> triangles,
                                 TimeRange times, std::uint32_t mask) {
    auto desc = detail::defaults(kiwami_moving_mesh_desc_init);
    desc.vertices = vertices.data();
    desc.vertex_count = step_count ? vertices.size() / step_count : 0;
    detail::require_equal(vertices.size(), desc.vertex_count * step_count, "vertices of all steps");
    desc.indices = detail::indices_of(triangles);
    desc.triangle_count = triangles.size();
    desc.step_count = step_count;
    desc.time_begin = times.begin;
    desc.time_end = times.end;
    desc.mask = mask;
    return detail::create_geometry(device, desc, kiwami_moving_mesh_create);
  }
};

class Spheres : public Geometry {
 public:
  Spheres(const Device& device, std::span<const Sphere> points, std::uint32_t mask = kAllMasks)
      : Geometry(create(device, points, mask)) {}

 private:
  static kiwami_geometry* create(const Device& device, std::span<const Sphere> points,
                                 std::uint32_t mask) {
    auto desc = detail::defaults(kiwami_spheres_desc_init);
    desc.points = points.data();
    desc.sphere_count = points.size();
    desc.mask = mask;
    return detail::create_geometry(device, desc, kiwami_spheres_create);
  }
};

/// Flat discs of centre and radius, each with a normal.
class Discs : public Geometry {
 public:
  Discs(const Device& device, std::span<const Sphere> points, std::span<const Vertex> normals,
        std::uint32_t mask = kAllMasks)
      : Geometry(create(device, points, normals, mask)) {}

 private:
  static kiwami_geometry* create(const Device& device, std::span<const Sphere> points,
                                 std::span<const Vertex> normals, std::uint32_t mask) {
    detail::require_equal(normals.size(), points.size(), "normals");
    auto desc = detail::defaults(kiwami_discs_desc_init);
    desc.points = points.data();
    desc.normals = normals.data();
    desc.disc_count = points.size();
    desc.mask = mask;
    return detail::create_geometry(device, desc, kiwami_discs_create);
  }
};

/// Round curve segments: segment i joins the points segments[i] and segments[i] + 1.
class Curves : public Geometry {
 public:
  Curves(const Device& device, std::span<const Sphere> points,
         std::span<const std::uint32_t> segments, std::uint32_t mask = kAllMasks)
      : Geometry(create(device, points, segments, mask)) {}

 private:
  static kiwami_geometry* create(const Device& device, std::span<const Sphere> points,
                                 std::span<const std::uint32_t> segments, std::uint32_t mask) {
    auto desc = detail::defaults(kiwami_curves_desc_init);
    desc.points = points.data();
    desc.point_count = points.size();
    desc.indices = segments.data();
    desc.segment_count = segments.size();
    desc.mask = mask;
    return detail::create_geometry(device, desc, kiwami_curves_create);
  }
};

}  // namespace kiwami

#endif
