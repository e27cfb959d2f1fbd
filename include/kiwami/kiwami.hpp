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
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "callbacks.hpp"
#include "lights.hpp"

namespace kiwami {

using SceneInfo = kiwami_scene_info;

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
  /// Leaves a geometry out, or takes it in again, under its number.
  void enable(std::uint32_t geometry_id, bool is_enabled = true) {
    check(kiwami_scene_enable(get(), geometry_id, is_enabled ? 1 : 0));
  }
  /// Puts another geometry in the place of one, under its number.
  void replace(std::uint32_t geometry_id, const Geometry& geometry) {
    check(kiwami_scene_replace(get(), geometry_id, geometry.get()));
  }
  void commit() { build(kiwami_scene_commit); }
  /// The same, and tells progress(double) how far it is: a fraction from 0 to 1, which never falls,
  /// from any thread, never from two at a time. Where it returns true, the commit ends with
  /// Error(KIWAMI_ERROR_CANCELLED); what it throws ends the commit and comes out of this call.
  template <std::predicate<double> Progress>
  void commit(Progress&& progress) {
    build(kiwami_scene_commit, progress);
  }
  /// As commit(), but keeps the tree where only vertices moved.
  void refit() { build(kiwami_scene_refit); }
  template <std::predicate<double> Progress>
  void refit(Progress&& progress) {
    build(kiwami_scene_refit, progress);
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
  void closest_hit(std::span<const Ray> rays, std::span<Hit> hits, const Query& query = {}) const {
    require_room(rays.size(), hits.size());
    check(query.run([&](const kiwami_query* c_query) {
      return kiwami_closest_hit(get(), rays.data(), 0, hits.data(), 0, rays.size(), c_query);
    }));
  }
  std::vector<Hit> closest_hit(std::span<const Ray> rays, const Query& query = {}) const {
    std::vector<Hit> hits(rays.size());
    closest_hit(rays, hits, query);
    return hits;
  }
  Hit closest_hit(const Ray& ray, const Query& query = {}) const {
    Hit hit;
    closest_hit({&ray, 1}, {&hit, 1}, query);
    return hit;
  }

  /// 1 for each ray that has a hit, 0 for the others.
  void any_hit(std::span<const Ray> rays, std::span<std::uint8_t> occluded,
               const Query& query = {}) const {
    require_room(rays.size(), occluded.size());
    check(query.run([&](const kiwami_query* c_query) {
      return kiwami_any_hit(get(), rays.data(), 0, occluded.data(), 0, rays.size(), c_query);
    }));
  }
  std::vector<std::uint8_t> any_hit(std::span<const Ray> rays, const Query& query = {}) const {
    std::vector<std::uint8_t> occluded(rays.size());
    any_hit(rays, occluded, query);
    return occluded;
  }
  bool any_hit(const Ray& ray, const Query& query = {}) const {
    std::uint8_t occluded = 0;
    any_hit({&ray, 1}, {&occluded, 1}, query);
    return occluded != 0;
  }

  /// The nearest max_hits hits of each ray, 0 standing for all, by rising distance.
  MultiHits multi_hit(std::span<const Ray> rays, std::uint32_t max_hits = 0,
                      const Query& query = {}) const {
    MultiHits found;
    found.offsets.resize(rays.size() + 1);
    found.hits.resize(rays.size());
    for (;;) {
      const kiwami_result result = query.run([&](const kiwami_query* c_query) {
        return kiwami_multi_hit(get(), rays.data(), 0, rays.size(), max_hits, found.hits.data(),
                                found.hits.size(), found.offsets.data(), c_query);
      });
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
  std::vector<std::uint32_t> count_hits(std::span<const Ray> rays, const Query& query = {}) const {
    std::vector<std::uint32_t> counts(rays.size());
    check(query.run([&](const kiwami_query* c_query) {
      return kiwami_count_hits(get(), rays.data(), 0, counts.data(), 0, rays.size(), c_query);
    }));
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
  void build(kiwami_result (*function)(kiwami_scene*)) {
    check(detail::run_call([&] { return function(get()); }));
  }
  template <typename Progress>
  void build(kiwami_result (*function)(kiwami_scene*), Progress& progress) {
    detail::ProgressReport<Progress> report{progress, {}};
    check(kiwami_scene_set_progress(get(), report.function(), &report));
    // The function is gone after this call, however it ends.
    const auto forget = [this](void*) { kiwami_scene_set_progress(get(), nullptr, nullptr); };
    const std::unique_ptr<void, decltype(forget)> until_return(&report, forget);
    const kiwami_result result = detail::run_call([&] { return function(get()); });
    if (report.thrown) std::rethrow_exception(report.thrown);
    check(result);
  }
  static void require_room(std::size_t rays, std::size_t answers) {
    if (rays != answers) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "there is room for " + std::to_string(answers) +
                                                     " answers, expected " + std::to_string(rays));
    }
  }

  Device device_;
};

/// An array of instances: each shows one of the scenes, moved by its transform.
class Instances : public Geometry {
 public:
  /// scene_indices say which scene each instance shows; none: all show the first one. masks are
  /// those of each instance, beside the mask of all. Everything is copied; the scenes are held.
  Instances(const Device& device, std::span<const Scene> scenes,
            std::span<const Transform> transforms,
            std::span<const std::uint32_t> scene_indices = {},
            std::span<const std::uint32_t> masks = {}, std::uint32_t mask = kAllMasks)
      : Geometry(create(device, scenes, transforms, scene_indices, masks, mask)) {}

 private:
  static kiwami_geometry* create(const Device& device, std::span<const Scene> scenes,
                                 std::span<const Transform> transforms,
                                 std::span<const std::uint32_t> scene_indices,
                                 std::span<const std::uint32_t> masks, std::uint32_t mask) {
    std::vector<kiwami_scene*> shown;
    for (const Scene& scene : scenes) shown.push_back(scene.get());
    auto desc = detail::defaults(kiwami_instances_desc_init);
    desc.scenes = shown.data();
    desc.scene_count = shown.size();
    desc.transforms = transforms.data();
    desc.count = transforms.size();
    if (!scene_indices.empty()) {
      detail::require_equal(scene_indices.size(), transforms.size(), "scene_indices");
      desc.scene_indices = scene_indices.data();
    }
    if (!masks.empty()) {
      detail::require_equal(masks.size(), transforms.size(), "masks");
      desc.masks = masks.data();
    }
    desc.mask = mask;
    return detail::create_geometry(device, desc, kiwami_instances_create);
  }
};

}  // namespace kiwami

#endif
