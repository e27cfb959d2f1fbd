// SPDX-License-Identifier: Apache-2.0
//
// Kiwami for C++20: handles that end by themselves, spans and exceptions, over the C interface
// alone: no other symbol of the library is used, so any compiler's code fits any build of it.
//
//   kiwami::Device device;
//   kiwami::Scene scene(device);
//   scene.attach(kiwami::Mesh(device, vertices, triangles));
//   scene.commit();
//   std::vector<kiwami::Hit> hits = scene.closest_hit(rays);
//
// Every function throws kiwami::Error where the C function that it calls returns an error. What the
// C headers say about threads, units and ownership holds here too.
#ifndef KIWAMI_KIWAMI_HPP
#define KIWAMI_KIWAMI_HPP

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "kiwami.h"

namespace kiwami {

using Ray = kiwami_ray;
using Hit = kiwami_hit;
using SceneInfo = kiwami_scene_info;
using DeviceInfo = kiwami_device_info;

/// Three numbers that lie together.
using Vertex = std::array<float, 3>;
using Triangle = std::array<std::uint32_t, 3>;

/// An error of the library: its number, and its sentence as what().
class Error : public std::runtime_error {
 public:
  Error(kiwami_result result, const std::string& sentence)
      : std::runtime_error(sentence), result_(result) {}
  kiwami_result result() const noexcept { return result_; }

 private:
  kiwami_result result_;
};

namespace detail {

inline void check(kiwami_result result, const kiwami_device* device = nullptr) {
  if (result == KIWAMI_OK) return;
  char sentence[1024];
  kiwami_last_error(device, sentence, sizeof(sentence));
  throw Error(result, sentence[0] != '\0' ? sentence : kiwami_result_name(result));
}

/// Owns one reference to an object of the C interface.
template <typename T, void (*kRetain)(T*), void (*kRelease)(T*)>
class Handle {
 public:
  Handle() = default;
  /// Takes over the caller's reference.
  explicit Handle(T* object) noexcept : object_(object) {}
  Handle(const Handle& other) noexcept : object_(other.object_) { kRetain(object_); }
  Handle(Handle&& other) noexcept : object_(std::exchange(other.object_, nullptr)) {}
  Handle& operator=(Handle other) noexcept {
    std::swap(object_, other.object_);
    return *this;
  }
  ~Handle() { kRelease(object_); }

  /// The object for calls of the C interface; it stays this handle's.
  T* get() const noexcept { return object_; }
  explicit operator bool() const noexcept { return object_ != nullptr; }

 private:
  T* object_ = nullptr;
};

}  // namespace detail

/// How a device is to be made; the defaults are the library's.
struct DeviceOptions {
  std::uint32_t isa = KIWAMI_ISA_AUTO;
  std::uint32_t thread_count = 0;
  bool validate = false;  ///< check the arguments of the trace calls too
};

/// Kernels of one ISA and the threads that run them. Copies name the same device.
class Device : public detail::Handle<kiwami_device, kiwami_device_retain, kiwami_device_release> {
 public:
  Device() : Device(DeviceOptions{}) {}
  explicit Device(const DeviceOptions& options) : Handle(create(options)) {}
  explicit Device(const kiwami_device_desc& desc) : Handle(create(desc)) {}

  DeviceInfo info() const {
    DeviceInfo info{};
    info.struct_size = sizeof(info);
    detail::check(kiwami_device_get_info(get(), &info), get());
    return info;
  }

 private:
  static kiwami_device* create(const kiwami_device_desc& desc) {
    kiwami_device* device = nullptr;
    detail::check(kiwami_device_create(&desc, &device));
    return device;
  }
  static kiwami_device* create(const DeviceOptions& options) {
    kiwami_device_desc desc;
    detail::check(kiwami_device_desc_init(&desc, sizeof(desc)));
    desc.isa = options.isa;
    desc.thread_count = options.thread_count;
    desc.flags = options.validate ? std::uint32_t{KIWAMI_DEVICE_VALIDATE} : 0u;
    return create(desc);
  }
};

/// Geometries of any kind.
class Geometry
    : public detail::Handle<kiwami_geometry, kiwami_geometry_retain, kiwami_geometry_release> {
 public:
  using Handle::Handle;
};

/// A triangle mesh.
class Mesh : public Geometry {
 public:
  /// Copies vertices and triangles; only a ray with (ray.mask & mask) != 0 meets the mesh.
  Mesh(const Device& device, std::span<const Vertex> vertices, std::span<const Triangle> triangles,
       std::uint32_t mask = ~std::uint32_t{0})
      : Geometry(create(device, vertices, triangles, mask)) {}
  /// With strides, offsets and shared buffers as the C interface has them.
  Mesh(const Device& device, const kiwami_triangle_mesh_desc& desc)
      : Geometry(create(device, desc)) {}

 private:
  static kiwami_geometry* create(const Device& device, const kiwami_triangle_mesh_desc& desc) {
    kiwami_geometry* geometry = nullptr;
    detail::check(kiwami_triangle_mesh_create(device.get(), &desc, &geometry), device.get());
    return geometry;
  }
  static kiwami_geometry* create(const Device& device, std::span<const Vertex> vertices,
                                 std::span<const Triangle> triangles, std::uint32_t mask) {
    kiwami_triangle_mesh_desc desc;
    detail::check(kiwami_triangle_mesh_desc_init(&desc, sizeof(desc)));
    desc.vertices = vertices.data();
    desc.vertex_count = vertices.size();
    // An empty span may be a null pointer, which stands for triangles without indices.
    static constexpr Triangle kNone{};
    desc.indices = triangles.empty() ? &kNone : triangles.data();
    desc.triangle_count = triangles.size();
    desc.mask = mask;
    return create(device, desc);
  }
};

namespace detail {

/// A callable as the progress function of a commit. No exception may cross C: it is kept.
template <typename Progress>
struct ProgressReport {
  Progress& progress;
  std::exception_ptr thrown;

  static kiwami_progress function() {
    return [](void* user, double fraction) -> std::int32_t {
      auto& report = *static_cast<ProgressReport*>(user);
      if (report.thrown) return 1;
      try {
        return report.progress(fraction) ? 1 : 0;
      } catch (...) {
        report.thrown = std::current_exception();
        return 1;
      }
    };
  }
};

}  // namespace detail

/// The hits of many rays: those of ray i are hits[offsets[i]] to hits[offsets[i + 1] - 1].
struct MultiHits {
  std::vector<std::uint64_t> offsets;
  std::vector<Hit> hits;

  std::span<const Hit> of(std::size_t ray) const {
    return std::span<const Hit>(hits).subspan(
        static_cast<std::size_t>(offsets[ray]),
        static_cast<std::size_t>(offsets[ray + 1] - offsets[ray]));
  }
};

/// Geometries under one acceleration structure. Copies name the same scene.
class Scene : public detail::Handle<kiwami_scene, kiwami_scene_retain, kiwami_scene_release> {
 public:
  explicit Scene(const Device& device) : Handle(create(device)), device_(device) {}

  const Device& device() const noexcept { return device_; }

  /// Returns the number that hits report. Takes effect with the next commit, as all changes do.
  std::uint32_t attach(const Geometry& geometry) {
    std::uint32_t geometry_id = 0;
    check(kiwami_scene_attach(get(), geometry.get(), &geometry_id));
    return geometry_id;
  }
  void detach(std::uint32_t geometry_id) { check(kiwami_scene_detach(get(), geometry_id)); }
  void set_parameter(std::uint32_t parameter, double value) {
    check(kiwami_scene_set_parameter(get(), parameter, value));
  }
  void commit() { check(kiwami_scene_commit(get())); }
  /// The same, and tells progress(double) how far it is: a fraction from 0 to 1, which never falls,
  /// from any thread, never from two at a time. Where it returns true, the commit ends with
  /// Error(KIWAMI_ERROR_CANCELLED); what it throws ends the commit and comes out of this call.
  template <std::predicate<double> Progress>
  void commit(Progress&& progress) {
    detail::ProgressReport<std::remove_reference_t<Progress>> report{progress, {}};
    check(kiwami_scene_set_progress(get(), report.function(), &report));
    const kiwami_result result = kiwami_scene_commit(get());
    check(kiwami_scene_set_progress(get(), nullptr, nullptr));
    if (report.thrown) std::rethrow_exception(report.thrown);
    check(result);
  }

  /// Saves the committed scene; a file of that name stays whole until all is written.
  void save(const std::string& path) const {
    kiwami_save_desc desc;
    check(kiwami_save_desc_init(&desc, sizeof(desc)));
    desc.path = path.c_str();
    check(kiwami_scene_save(get(), &desc, nullptr));
  }
  /// Loads a scene that save() wrote. flags are KIWAMI_LOAD_*.
  static Scene load(const Device& device, const std::string& path, std::uint32_t flags = 0) {
    kiwami_load_desc desc;
    detail::check(kiwami_load_desc_init(&desc, sizeof(desc)), device.get());
    desc.path = path.c_str();
    desc.flags = flags;
    kiwami_scene* scene = nullptr;
    detail::check(kiwami_scene_load(device.get(), &desc, &scene), device.get());
    return Scene(scene, device);
  }

  SceneInfo info() const {
    SceneInfo info{};
    info.struct_size = sizeof(info);
    check(kiwami_scene_get_info(get(), &info));
    return info;
  }

  /// The closest hit of each ray. The spans have the same size.
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits,
                   const kiwami_query* query = nullptr) const {
    require_room(rays.size(), hits.size());
    check(kiwami_closest_hit(get(), rays.data(), 0, hits.data(), 0, rays.size(), query));
  }
  std::vector<Hit> closest_hit(std::span<const Ray> rays,
                               const kiwami_query* query = nullptr) const {
    std::vector<Hit> hits(rays.size());
    closest_hit(rays, hits, query);
    return hits;
  }
  Hit closest_hit(const Ray& ray, const kiwami_query* query = nullptr) const {
    Hit hit;
    closest_hit({&ray, 1}, {&hit, 1}, query);
    return hit;
  }

  /// 1 for each ray that has a hit, 0 for the others.
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded,
               const kiwami_query* query = nullptr) const {
    require_room(rays.size(), occluded.size());
    check(kiwami_any_hit(get(), rays.data(), 0, occluded.data(), 0, rays.size(), query));
  }
  std::vector<std::uint8_t> any_hit(std::span<const Ray> rays,
                                    const kiwami_query* query = nullptr) const {
    std::vector<std::uint8_t> occluded(rays.size());
    any_hit(rays, occluded, query);
    return occluded;
  }
  bool any_hit(const Ray& ray, const kiwami_query* query = nullptr) const {
    std::uint8_t occluded = 0;
    any_hit({&ray, 1}, {&occluded, 1}, query);
    return occluded != 0;
  }

  /// The nearest max_hits hits of each ray, 0 standing for all, by rising distance.
  MultiHits multi_hit(std::span<const Ray> rays, std::uint32_t max_hits = 0,
                      const kiwami_query* query = nullptr) const {
    MultiHits found;
    found.offsets.resize(rays.size() + 1);
    found.hits.resize(rays.size());
    for (;;) {
      const kiwami_result result =
          kiwami_multi_hit(get(), rays.data(), 0, rays.size(), max_hits, found.hits.data(),
                           found.hits.size(), found.offsets.data(), query);
      const std::size_t needed = static_cast<std::size_t>(found.offsets.back());
      if (result != KIWAMI_ERROR_CAPACITY) {
        check(result);
        found.hits.resize(needed);
        return found;
      }
      found.hits.resize(needed);
    }
  }

  /// How many hits each ray has.
  std::vector<std::uint32_t> count_hits(std::span<const Ray> rays,
                                        const kiwami_query* query = nullptr) const {
    std::vector<std::uint32_t> counts(rays.size());
    check(kiwami_count_hits(get(), rays.data(), 0, counts.data(), 0, rays.size(), query));
    return counts;
  }

 private:
  Scene(kiwami_scene* scene, const Device& device) : Handle(scene), device_(device) {}
  static kiwami_scene* create(const Device& device) {
    kiwami_scene* scene = nullptr;
    detail::check(kiwami_scene_create(device.get(), &scene), device.get());
    return scene;
  }
  void check(kiwami_result result) const { detail::check(result, device_.get()); }
  static void require_room(std::size_t rays, std::size_t answers) {
    if (rays != answers) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "there is room for " + std::to_string(answers) +
                                                     " answers, expected " + std::to_string(rays));
    }
  }

  Device device_;
};

}  // namespace kiwami

#endif
