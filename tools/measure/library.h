// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <memory>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "measure/instance_paths.h"
#include "measure/shared_work.h"
#include "measure/tracer.h"
#include "scene/scene_file.h"

namespace kiwami::tools {

/// What a call of the library answered when it failed: its own sentence.
class LibraryError : public std::runtime_error {
 public:
  LibraryError(kiwami_result result, const std::string& sentence)
      : std::runtime_error(sentence), result_(result) {}
  kiwami_result result() const { return result_; }

 private:
  kiwami_result result_;
};

/// Throws LibraryError with the library's sentence (of this device's last error, or of the thread's)
/// unless result is KIWAMI_OK.
void throw_on_error(kiwami_result result, const kiwami_device* device = nullptr);

/// Owns a device.
class Device {
 public:
  /// `isa` is one of KIWAMI_ISA_*; 0 threads: one per processor.
  explicit Device(uint32_t isa = KIWAMI_ISA_AUTO, uint32_t thread_count = 0);
  /// Loops run by `work`, which must outlive the device.
  Device(uint32_t isa, SharedWork& work);
  ~Device() { kiwami_device_release(device_); }
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;

  kiwami_device* get() const { return device_; }
  const kiwami_device_info& info() const { return info_; }

 private:
  void create(const kiwami_device_desc& desc);

  kiwami_device* device_ = nullptr;
  kiwami_device_info info_{};
};

/// One of KIWAMI_PARAMETER_* and its value.
struct Parameter {
  uint32_t number;
  double value;
};

/// How a scene's acceleration structure is to be built.
struct BuildOptions {
  uint32_t bvh_width = 0;  ///< 0: the device's default
  bool merge_leaves = true;
  uint32_t builder = KIWAMI_BUILDER_BINNED_SAH;
  std::vector<uint32_t> optimizers = {};  ///< run in this order
  uint32_t contraction = KIWAMI_CONTRACTION_OPTIMAL;
  uint32_t layout = KIWAMI_LAYOUT_FAST;
  std::vector<Parameter> parameters = {};  ///< set after the others, in this order
  uint32_t leaf_mask_level = 0;  ///< of opacity micromaps of leaves for all triangles; 0: none
};

/// What a KIWAMI_QUALITY_* stands for.
BuildOptions build_options_of(uint32_t quality);

/// The parameter of "bin_count=16": NAME is that of KIWAMI_PARAMETER_NAME in lower case, or its
/// number. Throws LibraryError when it is neither, or VALUE is not a number.
Parameter parse_parameter(const std::string& text);

/// The names of the methods of a KIWAMI_STAGE_*.
std::vector<std::string> method_names(uint32_t stage);

/// The number of a method of a KIWAMI_STAGE_*; throws LibraryError that lists the names.
uint32_t method_of_name(uint32_t stage, const std::string& name);

/// Whether a builder leaves no binary tree to optimise and contract.
bool makes_wide_tree(uint32_t builder);

/// Whether an optimiser needs no binary tree.
bool acts_on_wide_tree(uint32_t optimizer);

/// "binned_sah + rotation, optimal, merged", and ", compact" where that is the layout.
std::string pipeline_name(const BuildOptions& options);

/// A tree, its nodes breadth first, and its cost.
struct MeasuredTree {
  std::vector<kiwami_bvh_node> nodes;
  std::vector<kiwami_bvh_node_measures> measures;  ///< of each node
  kiwami_bvh_measures total;
};

/// Owns a committed scene whose geometry i is mesh i of the file; or, of a file with instances, one
/// of these over a scene of each mesh. It shares the file's buffers, so the file must outlive it.
class BuiltScene : public Tracer {
 public:
  BuiltScene(const Device& device, const SceneFile& file, const BuildOptions& options = {});
  /// A scene that was saved, with its trees; `load_flags` are KIWAMI_LOAD_*. Width 0: as it was
  /// saved. What the file holds serves to carry hits out of instances, and must outlive the scene;
  /// without it, they stay there.
  BuiltScene(const Device& device, const std::string& path, uint32_t load_flags,
             const SceneFile* file = nullptr, uint32_t bvh_width = 0);
  ~BuiltScene() override { release(); }
  BuiltScene(const BuiltScene&) = delete;
  BuiltScene& operator=(const BuiltScene&) = delete;

  /// After the file's vertices have moved; not of a scene with instances.
  void refit();
  /// Commits anew after those of one mesh have moved.
  void commit_moved(size_t mesh);

  /// Of a scene with instances: counts of triangles are those in the world, bytes and seconds are
  /// those of all scenes, fill rates their means.
  const kiwami_scene_info& info() const { return info_; }
  /// Saves it with its tree, and tells the size of the file.
  uint64_t save(const std::string& path) const;
  /// As of the flattened file: where there are instances, a hit's geometry is the instance, and its
  /// normal that of the moved triangle.
  void closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const override;
  /// As the library says it.
  void own_closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const;
  void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const;
  /// Of the hits that the filter accepts.
  void filtered_hits(std::span<const kiwami_ray> rays, kiwami_filter_function filter, void* user,
                     std::span<kiwami_hit> hits) const;
  /// The same with one call a ray, each on the calling thread.
  void closest_hits_singly(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const;
  void any_hits_singly(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const;
  /// The nearest max_hits of each ray (0: all): those of ray i are hits[offsets[i]] to
  /// hits[offsets[i + 1] - 1]. Returns their number; what is beyond hits is lost.
  uint64_t multi_hits(std::span<const kiwami_ray> rays, uint32_t max_hits,
                      std::span<uint64_t> offsets, std::span<kiwami_hit> hits) const;
  /// What the tree costs by the costs that it was built with.
  kiwami_bvh_measures measures() const;
  /// The same node by node; `flags` are some of KIWAMI_MEASURE_*.
  MeasuredTree measured_tree(uint32_t flags) const;
  /// What the rays visit, each traced alone.
  kiwami_visits visits(std::span<const kiwami_ray> rays, bool any_hit) const;

 private:
  kiwami_scene* make_scene(kiwami_device* device, const BuildOptions& options);
  void build(kiwami_device* device, const SceneFile& file, const BuildOptions& options);
  void build_instances(kiwami_device* device, const SceneFile& file, const BuildOptions& options);
  void attach(kiwami_device* device, kiwami_scene* scene, const Mesh& mesh,
              uint32_t leaf_mask_level);
  void loaded_closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const;
  void release();
  kiwami_bvh_measures measure(const kiwami_bvh* bvh, uint32_t flags,
                              kiwami_bvh_node_measures* nodes) const;

  std::vector<kiwami_scene*> shown_;  ///< the scenes of instances
  kiwami_scene* scene_ = nullptr;
  std::vector<kiwami_geometry*> geometries_;
  bool has_instances_ = false;            ///< which are the last geometry
  std::unique_ptr<InstancePaths> paths_;  ///< of a scene that was saved
  kiwami_scene_info info_{};
  double node_cost_ = 1.0;
  double leaf_cost_ = 1.0;
};

/// What the beginning of a file that was saved says.
kiwami_file_info file_info_of(const Device& device, const std::string& path);

/// The KIWAMI_ISA_* that can run here, from scalar to the best.
std::vector<uint32_t> available_isas();

/// The number of an ISA's lower-case name, "auto" included; throws LibraryError for another name.
uint32_t isa_of_name(const std::string& name);

}  // namespace kiwami::tools
