// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "kernels/light_kernels.h"
#include "lights/committed_lights.h"

namespace kiwami {

/// Triangles that become lights: what kiwami_light_mesh_desc describes, checked.
struct LightMesh {
  const unsigned char* vertices;
  size_t vertex_stride;
  const unsigned char* indices;  ///< or null
  size_t index_stride;
  const unsigned char* radiances;  ///< or null
  size_t radiance_stride;
  uint32_t vertex_count;
  uint32_t triangle_count;
  float radiance;
  uint32_t user_id, user_id_step;
  bool is_two_sided;
  uint64_t link_mask;
};

/// A set of lights and the tree that was last committed over it.
class LightTree : public Object<LightTree> {
 public:
  static constexpr size_t kMaxLightCount = size_t{1} << 26;
  static constexpr size_t kMaxInstanceCount = size_t{1} << 20;

  /// Throws Error(OUT_OF_MEMORY). desc is checked.
  static LightTree* create(Device& device, const kiwami_light_tree_desc& desc);
  static void destroy(LightTree* tree) noexcept;

  LightTree(Device& device, const kiwami_light_tree_desc& desc);

  // All throw Error, and then nothing has changed.

  /// Lights of kiwami_light, stride bytes apart. Returns the number of the first.
  uint32_t add_lights(const unsigned char* lights, size_t stride, size_t count);
  uint32_t add_mesh(const LightMesh& mesh);
  uint32_t add_instance(const LightInstance& instance);
  void set_lights(uint32_t first, const unsigned char* lights, size_t stride, size_t count);
  void set_powers(uint32_t first, const unsigned char* powers, size_t stride, size_t count);
  void set_instance(uint32_t number, const LightInstance& instance);
  void commit();
  void refit();
  /// Takes over lights and their ids, of a set without any.
  void restore_lights(std::span<const LightRecord> lights, std::span<const uint32_t> user_ids);
  /// Takes the place of a commit: a tree of a shape that was saved, which fits.
  void restore(const LightShape& shape, double build_seconds);

  Device& device() const { return *device_; }
  /// What it was made with, but for the width, which is chosen by now.
  kiwami_light_tree_desc desc() const;
  uint32_t width() const { return width_; }
  /// The lights and instances as they are by now.
  const LightSet& set() const { return *set_; }
  /// Null before the first commit.
  CommittedLights* committed() const { return committed_.get(); }
  const LightKernels& kernels() const { return kernels_; }
  kiwami_light_tree_info info() const;  ///< of what is committed

 private:
  LightInput input() const;
  LightSet& own_set(size_t more_lights, size_t more_instances);
  void check_new(size_t count) const;
  void check_present(uint32_t first, size_t count) const;

  Reference<Device> device_;
  uint32_t width_;
  uint32_t builder_;
  uint32_t flags_;
  float distant_probability_;
  LightKernels kernels_;
  Reference<LightSet> set_;
  Reference<CommittedLights> committed_;
};

}  // namespace kiwami
