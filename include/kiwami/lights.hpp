// SPDX-License-Identifier: Apache-2.0
//
// Kiwami for C++20: sets of many lights, and which of them a point should ask. Use kiwami.hpp.
#ifndef KIWAMI_LIGHTS_HPP
#define KIWAMI_LIGHTS_HPP

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometries.hpp"

namespace kiwami {

using Light = kiwami_light;
using LightReceiver = kiwami_light_receiver;
using LightChoice = kiwami_light_choice;
using LightName = kiwami_light_name;
using LightTreeInfo = kiwami_light_tree_info;

/// How a set of lights is to be made; the defaults are the library's.
struct LightTreeOptions {
  std::uint32_t width = 0;  ///< children of a node: 2, 4, 8 or 16; 0: the device's default
  std::uint32_t builder = KIWAMI_LIGHT_BUILDER_SAOH;
  std::uint32_t flags = 0;           ///< KIWAMI_LIGHT_TREE_*
  float distant_probability = 0.0f;  ///< see kiwami_light_tree_desc
};

/// How the triangles of a mesh shine.
struct LightMeshOptions {
  float radiance = 1.0f;                  ///< of each triangle
  std::span<const float> radiances = {};  ///< one each, in place of radiance
  bool is_two_sided = false;
  std::uint64_t link_mask = ~std::uint64_t{0};
  std::uint32_t user_id = 0;  ///< of triangle 0; that of triangle i is i times the step more
  std::uint32_t user_id_step = 0;
};

/// Lights, among which points choose in proportion to what may reach them. Changes take effect with
/// commit() or refit(). Copies name the same set.
class LightTree : public detail::Handle<kiwami_light_tree, kiwami_light_tree_retain,
                                        kiwami_light_tree_release> {
 public:
  explicit LightTree(const Device& device, const LightTreeOptions& options = {})
      : Handle(create(device, options)), device_(device) {}

  /// Returns the number of the first.
  std::uint32_t add_lights(std::span<const Light> lights) {
    std::uint32_t first = 0;
    check(kiwami_light_tree_add_lights(get(), lights.data(), 0, lights.size(), &first));
    return first;
  }
  /// Makes a light of each triangle; returns the number of the first.
  std::uint32_t add_mesh(std::span<const Vertex> vertices, std::span<const Triangle> triangles,
                         const LightMeshOptions& options = {}) {
    auto desc = detail::defaults(kiwami_light_mesh_desc_init);
    desc.flags = options.is_two_sided ? std::uint32_t{KIWAMI_LIGHT_TWO_SIDED} : 0u;
    desc.vertices = vertices.data();
    desc.vertex_count = vertices.size();
    desc.indices = detail::indices_of(triangles);
    desc.triangle_count = triangles.size();
    desc.radiance = options.radiance;
    if (!options.radiances.empty()) {
      detail::require_equal(options.radiances.size(), triangles.size(), "radiances");
      desc.radiances = options.radiances.data();
    }
    desc.link_mask = options.link_mask;
    desc.user_id = options.user_id;
    desc.user_id_step = options.user_id_step;
    std::uint32_t first = 0;
    check(kiwami_light_tree_add_mesh(get(), &desc, &first));
    return first;
  }
  /// Shows another set, as it is committed now, through a transform; returns its number.
  std::uint32_t add_instance(const LightTree& shown, const Transform& local_to_world,
                             float power_scale = 1.0f) {
    auto desc = detail::defaults(kiwami_light_instance_desc_init);
    desc.power_scale = power_scale;
    desc.tree = shown.get();
    for (std::size_t i = 0; i < local_to_world.size(); ++i) {
      desc.local_to_world[i] = local_to_world[i];
    }
    std::uint32_t number = 0;
    check(kiwami_light_tree_add_instance(get(), &desc, &number));
    return number;
  }
  /// Replaces the lights from first on.
  void set_lights(std::uint32_t first, std::span<const Light> lights) {
    check(kiwami_light_tree_set_lights(get(), first, lights.data(), 0, lights.size()));
  }
  /// Gives the lights from first on other powers.
  void set_powers(std::uint32_t first, std::span<const float> powers) {
    check(kiwami_light_tree_set_powers(get(), first, powers.data(), 0, powers.size()));
  }
  void commit() { check(kiwami_light_tree_commit(get())); }
  /// As commit(), but keeps the shape of the tree.
  void refit() { check(kiwami_light_tree_refit(get())); }

  /// Saves the committed set; a file of that name stays whole until all is written.
  void save(const std::string& path) const {
    auto desc = detail::defaults(kiwami_save_desc_init);
    desc.path = path.c_str();
    check(kiwami_light_tree_save(get(), &desc, nullptr));
  }
  /// Loads a set that save() wrote. flags are KIWAMI_LOAD_*.
  static LightTree load(const Device& device, const std::string& path, std::uint32_t flags = 0) {
    auto desc = detail::defaults(kiwami_load_desc_init);
    desc.path = path.c_str();
    desc.flags = flags;
    kiwami_light_tree* tree = nullptr;
    detail::check(kiwami_light_tree_load(device.get(), &desc, &tree), device.get());
    return LightTree(tree, device);
  }

  LightTreeInfo info() const {
    LightTreeInfo info{};
    info.struct_size = sizeof(info);
    check(kiwami_light_tree_get_info(get(), &info));
    return info;
  }

  /// Lets each receiver choose: query->max_choices choices each, one without a query.
  std::vector<LightChoice> sample(std::span<const LightReceiver> receivers,
                                  const kiwami_light_query* query = nullptr) const {
    std::vector<LightChoice> choices(receivers.size() * (query ? query->max_choices : 1u));
    check(kiwami_light_sample(get(), receivers.data(), 0, choices.data(), 0, receivers.size(),
                              query));
    return choices;
  }
  /// The probability with which each receiver chooses the light that is named beside it.
  std::vector<float> pdf(std::span<const LightReceiver> receivers,
                         std::span<const LightName> lights,
                         const kiwami_light_query* query = nullptr) const {
    detail::require_equal(lights.size(), receivers.size(), "lights");
    std::vector<float> probabilities(receivers.size());
    check(kiwami_light_pdf(get(), receivers.data(), 0, lights.data(), 0, probabilities.data(), 0,
                           receivers.size(), query));
    return probabilities;
  }

 private:
  LightTree(kiwami_light_tree* tree, const Device& device) : Handle(tree), device_(device) {}

  static kiwami_light_tree* create(const Device& device, const LightTreeOptions& options) {
    auto desc = detail::defaults(kiwami_light_tree_desc_init);
    desc.width = options.width;
    desc.builder = options.builder;
    desc.flags = options.flags;
    desc.distant_probability = options.distant_probability;
    kiwami_light_tree* tree = nullptr;
    detail::check(kiwami_light_tree_create(device.get(), &desc, &tree), device.get());
    return tree;
  }
  void check(kiwami_result result) const { detail::check(result, device_.get()); }

  Device device_;
};

}  // namespace kiwami

#endif
