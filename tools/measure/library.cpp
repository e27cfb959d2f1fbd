// SPDX-License-Identifier: Apache-2.0
#include "measure/library.h"

#include <algorithm>
#include <charconv>
#include <optional>

#include "measure/file_geometries.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kIsas[] = {KIWAMI_ISA_SCALAR, KIWAMI_ISA_SSE, KIWAMI_ISA_AVX2,
                              KIWAMI_ISA_AVX512};

constexpr struct {
  const char* name;
  uint32_t number;
} kParameters[] = {{"bvh_width", KIWAMI_PARAMETER_BVH_WIDTH},
                   {"merge_leaves", KIWAMI_PARAMETER_MERGE_LEAVES},
                   {"merge_ring", KIWAMI_PARAMETER_MERGE_RING},
                   {"bin_count", KIWAMI_PARAMETER_BIN_COUNT},
                   {"max_leaf_size", KIWAMI_PARAMETER_MAX_LEAF_SIZE},
                   {"node_cost", KIWAMI_PARAMETER_NODE_COST},
                   {"leaf_cost", KIWAMI_PARAMETER_LEAF_COST},
                   {"validate_build", KIWAMI_PARAMETER_VALIDATE_BUILD},
                   {"contraction", KIWAMI_PARAMETER_CONTRACTION},
                   {"builder", KIWAMI_PARAMETER_BUILDER},
                   {"split_budget", KIWAMI_PARAMETER_SPLIT_BUDGET},
                   {"split_alpha", KIWAMI_PARAMETER_SPLIT_ALPHA},
                   {"bin_halving", KIWAMI_PARAMETER_BIN_HALVING},
                   {"reassign", KIWAMI_PARAMETER_REASSIGN},
                   {"aac_quality", KIWAMI_PARAMETER_AAC_QUALITY},
                   {"curve_code", KIWAMI_PARAMETER_CURVE_CODE},
                   {"lbvh_delta", KIWAMI_PARAMETER_LBVH_DELTA},
                   {"lbvh_chunk_size", KIWAMI_PARAMETER_LBVH_CHUNK_SIZE},
                   {"layout", KIWAMI_PARAMETER_LAYOUT},
                   {"two_level", KIWAMI_PARAMETER_TWO_LEVEL},
                   {"quality", KIWAMI_PARAMETER_QUALITY},
                   {"rebraid", KIWAMI_PARAMETER_REBRAID},
                   {"rebraid_budget", KIWAMI_PARAMETER_REBRAID_BUDGET},
                   {"divide_time", KIWAMI_PARAMETER_DIVIDE_TIME}};

std::string parameter_names() {
  std::string names;
  for (const auto& parameter : kParameters) {
    names += (names.empty() ? "" : ", ") + std::string(parameter.name);
  }
  return names;
}

/// Numbers of methods are below this.
constexpr uint32_t kMethodLimit = 256;

const char* stage_name(uint32_t stage) {
  switch (stage) {
    case KIWAMI_STAGE_BUILDER:
      return "builder";
    case KIWAMI_STAGE_OPTIMIZER:
      return "optimizer";
    default:
      return "contraction";
  }
}

/// The whole text as a number, or nothing.
template <typename T>
std::optional<T> parse_whole(const std::string& text) {
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

kiwami_query calling_thread_query() {
  kiwami_query query;
  throw_on_error(kiwami_query_init(&query, sizeof query), nullptr);
  query.flags = KIWAMI_QUERY_CALLING_THREAD;
  return query;
}

kiwami_scene_info info_of(const kiwami_scene* scene) {
  kiwami_scene_info info{};
  info.struct_size = sizeof info;
  throw_on_error(kiwami_scene_get_info(scene, &info), nullptr);
  return info;
}

kiwami_scene_info commit(kiwami_scene* scene) {
  throw_on_error(kiwami_scene_commit(scene), nullptr);
  return info_of(scene);
}

/// Adds what a scene under instances costs; the fill rates are sums until divided.
void add_costs(const kiwami_scene_info& shown, kiwami_scene_info& all) {
  all.skipped_count += shown.skipped_count;
  all.node_count += shown.node_count;
  all.leaf_block_count += shown.leaf_block_count;
  all.node_bytes += shown.node_bytes;
  all.leaf_bytes += shown.leaf_bytes;
  all.total_bytes += shown.total_bytes;
  all.peak_build_bytes += shown.peak_build_bytes;
  all.build_seconds += shown.build_seconds;
  all.reference_count += shown.reference_count;
  all.node_fill += shown.node_fill * static_cast<double>(shown.node_count);
  all.leaf_fill += shown.leaf_fill * static_cast<double>(shown.leaf_block_count);
}

/// Holds the reference to a scene's tree.
class Tree {
 public:
  explicit Tree(const kiwami_scene* scene) {
    throw_on_error(kiwami_scene_get_bvh(scene, &bvh_), nullptr);
  }
  ~Tree() { kiwami_bvh_release(bvh_); }
  Tree(const Tree&) = delete;
  Tree& operator=(const Tree&) = delete;
  const kiwami_bvh* get() const { return bvh_; }

 private:
  kiwami_bvh* bvh_ = nullptr;
};

}  // namespace

void throw_on_error(kiwami_result result, const kiwami_device* device) {
  if (result == KIWAMI_OK) return;
  std::string sentence(kiwami_last_error(device, nullptr, 0), '\0');
  kiwami_last_error(device, sentence.data(), sentence.size());
  while (!sentence.empty() && (sentence.back() == '\0' || sentence.back() == '.')) {
    sentence.pop_back();
  }
  throw LibraryError(result, sentence.empty() ? kiwami_result_name(result) : sentence);
}

Device::Device(uint32_t isa, uint32_t thread_count) {
  kiwami_device_desc desc;
  throw_on_error(kiwami_device_desc_init(&desc, sizeof desc), nullptr);
  desc.isa = isa;
  desc.thread_count = thread_count;
  create(desc);
}

Device::Device(uint32_t isa, SharedWork& work) {
  kiwami_device_desc desc;
  throw_on_error(kiwami_device_desc_init(&desc, sizeof desc), nullptr);
  desc.isa = isa;
  desc.runner = SharedWork::run;
  desc.runner_user = &work;
  desc.runner_width = work.processors();
  create(desc);
}

void Device::create(const kiwami_device_desc& desc) {
  throw_on_error(kiwami_device_create(&desc, &device_), nullptr);
  info_.struct_size = sizeof info_;
  const kiwami_result result = kiwami_device_get_info(device_, &info_);
  if (result != KIWAMI_OK) kiwami_device_release(device_);
  throw_on_error(result, nullptr);
}

BuiltScene::BuiltScene(const Device& device, const SceneFile& file, const BuildOptions& options) {
  try {
    if (file.instances.empty()) {
      build(device.get(), file, options);
    } else {
      build_instances(device.get(), file, options);
    }
  } catch (...) {
    release();
    throw;
  }
}

BuiltScene::BuiltScene(const Device& device, const std::string& path, uint32_t load_flags,
                       const SceneFile* file, uint32_t bvh_width) {
  kiwami_load_desc desc;
  throw_on_error(kiwami_load_desc_init(&desc, sizeof desc), device.get());
  desc.path = path.c_str();
  desc.flags = load_flags;
  desc.bvh_width = bvh_width;
  throw_on_error(kiwami_scene_load(device.get(), &desc, &scene_), device.get());
  try {
    info_ = info_of(scene_);
    if (file) paths_ = std::make_unique<InstancePaths>(device.get(), *file);
  } catch (...) {
    kiwami_scene_release(scene_);
    throw;
  }
}

uint64_t BuiltScene::save(const std::string& path) const {
  kiwami_save_desc desc;
  throw_on_error(kiwami_save_desc_init(&desc, sizeof desc), nullptr);
  desc.path = path.c_str();
  uint64_t bytes = 0;
  throw_on_error(kiwami_scene_save(scene_, &desc, &bytes), nullptr);
  return bytes;
}

void BuiltScene::release() {
  for (kiwami_geometry* geometry : geometries_) kiwami_geometry_release(geometry);
  kiwami_scene_release(scene_);
  for (kiwami_scene* scene : shown_) kiwami_scene_release(scene);
}

void BuiltScene::build(kiwami_device* device, const SceneFile& file, const BuildOptions& options) {
  scene_ = make_scene(device, options);
  for (const Mesh& mesh : file.meshes) attach(device, scene_, mesh, options.leaf_mask_level);
  info_ = commit(scene_);
  // What moves has no place in that number.
  if (file.is_moving()) info_.triangle_count = file.triangle_count() - info_.skipped_count;
}

void BuiltScene::attach(kiwami_device* device, kiwami_scene* scene, const Mesh& mesh,
                        uint32_t leaf_mask_level) {
  kiwami_geometry* const geometry = make_geometry(device, mesh);
  geometries_.push_back(geometry);
  if (leaf_mask_level != 0) set_leaf_mask(device, geometry, mesh, leaf_mask_level);
  throw_on_error(kiwami_scene_attach(scene, geometry, nullptr), device);
}

void BuiltScene::refit() {
  for (kiwami_geometry* geometry : geometries_) {
    throw_on_error(kiwami_triangle_mesh_update_vertices(geometry, nullptr, 0, 0), nullptr);
  }
  throw_on_error(kiwami_scene_refit(scene_), nullptr);
  info_ = info_of(scene_);
}

void BuiltScene::build_instances(kiwami_device* device, const SceneFile& file,
                                 const BuildOptions& options) {
  has_instances_ = true;
  kiwami_scene_info shown{};
  for (const Mesh& mesh : file.meshes) {
    shown_.push_back(make_scene(device, options));
    attach(device, shown_.back(), mesh, options.leaf_mask_level);
    add_costs(commit(shown_.back()), shown);
  }
  scene_ = make_scene(device, options);
  kiwami_geometry* const geometry = make_instances(device, file, shown_);
  geometries_.push_back(geometry);
  throw_on_error(kiwami_scene_attach(scene_, geometry, nullptr), device);
  info_ = commit(scene_);
  add_costs(shown, info_);
  info_.triangle_count = file.triangle_count();
  info_.node_fill = shown.node_fill / static_cast<double>(std::max<uint64_t>(shown.node_count, 1));
  info_.leaf_fill =
      shown.leaf_fill / static_cast<double>(std::max<uint64_t>(shown.leaf_block_count, 1));
}

void BuiltScene::commit_moved(size_t mesh) {
  throw_on_error(kiwami_triangle_mesh_update_vertices(geometries_[mesh], nullptr, 0, 0), nullptr);
  info_ = commit(scene_);
}

kiwami_scene* BuiltScene::make_scene(kiwami_device* device, const BuildOptions& options) {
  kiwami_scene* scene = nullptr;
  throw_on_error(kiwami_scene_create(device, &scene), device);
  try {
    const auto set = [&](uint32_t parameter, double value) {
      throw_on_error(kiwami_scene_set_parameter(scene, parameter, value), device);
    };
    set(KIWAMI_PARAMETER_BVH_WIDTH, options.bvh_width);
    set(KIWAMI_PARAMETER_MERGE_LEAVES, options.merge_leaves ? 1.0 : 0.0);
    set(KIWAMI_PARAMETER_BUILDER, options.builder);
    throw_on_error(
        kiwami_scene_set_optimizers(scene, options.optimizers.data(), options.optimizers.size()),
        device);
    set(KIWAMI_PARAMETER_CONTRACTION, options.contraction);
    set(KIWAMI_PARAMETER_LAYOUT, options.layout);
    for (const Parameter& parameter : options.parameters) {
      set(parameter.number, parameter.value);
      if (parameter.number == KIWAMI_PARAMETER_NODE_COST) node_cost_ = parameter.value;
      if (parameter.number == KIWAMI_PARAMETER_LEAF_COST) leaf_cost_ = parameter.value;
    }
  } catch (...) {
    kiwami_scene_release(scene);
    throw;
  }
  return scene;
}

void BuiltScene::own_closest_hits(std::span<const kiwami_ray> rays,
                                  std::span<kiwami_hit> hits) const {
  throw_on_error(kiwami_closest_hit(scene_, rays.data(), 0, hits.data(), 0, rays.size(), nullptr),
                 nullptr);
}

void BuiltScene::closest_hits(std::span<const kiwami_ray> rays, std::span<kiwami_hit> hits) const {
  if (paths_ && !paths_->empty()) return loaded_closest_hits(rays, hits);
  own_closest_hits(rays, hits);
  if (!has_instances_) return;
  for (size_t i = 0; i < hits.size(); ++i) {
    if (hits[i].instance_id == KIWAMI_INVALID_ID) continue;
    std::array<float, 12> matrix;
    throw_on_error(kiwami_instances_transform(geometries_.back(), hits[i].instance_id, rays[i].time,
                                              matrix.data()),
                   nullptr);
    move_to_world(matrix, hits[i]);
  }
}

void BuiltScene::loaded_closest_hits(std::span<const kiwami_ray> rays,
                                     std::span<kiwami_hit> hits) const {
  kiwami_query query;
  throw_on_error(kiwami_query_init(&query, sizeof query), nullptr);
  std::vector<uint32_t> paths(rays.size() * KIWAMI_MAX_INSTANCE_DEPTH);
  query.instance_paths = paths.data();
  throw_on_error(kiwami_closest_hit(scene_, rays.data(), 0, hits.data(), 0, rays.size(), &query),
                 nullptr);
  for (size_t i = 0; i < hits.size(); ++i) {
    paths_->move_to_world(&paths[i * KIWAMI_MAX_INSTANCE_DEPTH], rays[i].time, hits[i]);
  }
}

void BuiltScene::any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const {
  throw_on_error(kiwami_any_hit(scene_, rays.data(), 0, occluded.data(), 0, rays.size(), nullptr),
                 nullptr);
}

void BuiltScene::filtered_hits(std::span<const kiwami_ray> rays, kiwami_filter_function filter,
                               void* user, std::span<kiwami_hit> hits) const {
  kiwami_query query;
  throw_on_error(kiwami_query_init(&query, sizeof query), nullptr);
  query.filter = filter;
  query.filter_user = user;
  throw_on_error(kiwami_closest_hit(scene_, rays.data(), 0, hits.data(), 0, rays.size(), &query),
                 nullptr);
}

uint64_t BuiltScene::multi_hits(std::span<const kiwami_ray> rays, uint32_t max_hits,
                                std::span<uint64_t> offsets, std::span<kiwami_hit> hits) const {
  kiwami_hit* const target = hits.empty() ? nullptr : hits.data();
  const kiwami_result result = kiwami_multi_hit(scene_, rays.data(), 0, rays.size(), max_hits,
                                                target, hits.size(), offsets.data(), nullptr);
  if (result != KIWAMI_ERROR_CAPACITY) throw_on_error(result, nullptr);
  return offsets.back();
}

void BuiltScene::closest_hits_singly(std::span<const kiwami_ray> rays,
                                     std::span<kiwami_hit> hits) const {
  const kiwami_query query = calling_thread_query();
  for (size_t i = 0; i < rays.size(); ++i) {
    throw_on_error(kiwami_closest_hit(scene_, &rays[i], 0, &hits[i], 0, 1, &query), nullptr);
  }
}

void BuiltScene::any_hits_singly(std::span<const kiwami_ray> rays,
                                 std::span<uint8_t> occluded) const {
  const kiwami_query query = calling_thread_query();
  for (size_t i = 0; i < rays.size(); ++i) {
    throw_on_error(kiwami_any_hit(scene_, &rays[i], 0, &occluded[i], 0, 1, &query), nullptr);
  }
}

kiwami_bvh_measures BuiltScene::measures() const {
  const Tree tree(scene_);
  return measure(tree.get(), 0, nullptr);
}

MeasuredTree BuiltScene::measured_tree(uint32_t flags) const {
  const Tree tree(scene_);
  kiwami_bvh_info info{};
  info.struct_size = sizeof info;
  throw_on_error(kiwami_bvh_get_info(tree.get(), &info), nullptr);
  MeasuredTree measured{};
  measured.nodes.resize(info.node_count);
  measured.measures.resize(info.node_count);
  throw_on_error(kiwami_bvh_get_nodes(tree.get(), 0, info.node_count, measured.nodes.data(), 0),
                 nullptr);
  measured.total = measure(tree.get(), flags, measured.measures.data());
  return measured;
}

kiwami_bvh_measures BuiltScene::measure(const kiwami_bvh* bvh, uint32_t flags,
                                        kiwami_bvh_node_measures* nodes) const {
  kiwami_bvh_measure_desc desc;
  throw_on_error(kiwami_bvh_measure_desc_init(&desc, sizeof desc), nullptr);
  desc.flags = flags;
  desc.node_cost = node_cost_;
  desc.leaf_cost = leaf_cost_;
  kiwami_bvh_measures measures{};
  measures.struct_size = sizeof measures;
  throw_on_error(kiwami_bvh_measure(bvh, &desc, &measures, nodes, 0), nullptr);
  return measures;
}

kiwami_visits BuiltScene::visits(std::span<const kiwami_ray> rays, bool any_hit) const {
  kiwami_visits visits{};
  visits.struct_size = sizeof visits;
  throw_on_error(
      kiwami_scene_count_visits(scene_, rays.data(), 0, rays.size(),
                                any_hit ? KIWAMI_COUNT_ANY_HIT : KIWAMI_COUNT_CLOSEST_HIT, &visits,
                                nullptr, 0),
      nullptr);
  return visits;
}

std::vector<std::string> method_names(uint32_t stage) {
  std::vector<std::string> names;
  for (uint32_t method = 0; method < kMethodLimit; ++method) {
    const char* name = kiwami_method_name(stage, method);
    if (name != nullptr) names.emplace_back(name);
  }
  return names;
}

uint32_t method_of_name(uint32_t stage, const std::string& name) {
  for (uint32_t method = 0; method < kMethodLimit; ++method) {
    const char* known = kiwami_method_name(stage, method);
    if (known != nullptr && name == known) return method;
  }
  std::string expected;
  for (const std::string& known : method_names(stage)) {
    expected += (expected.empty() ? "" : ", ") + known;
  }
  throw LibraryError(KIWAMI_ERROR_INVALID_ARGUMENT,
                     std::string("there is no ") + stage_name(stage) + " '" + name +
                         "', expected " + (expected.empty() ? "none" : "one of " + expected));
}

BuildOptions build_options_of(uint32_t quality) {
  BuildOptions options;
  size_t count = 0;
  options.optimizers.resize(KIWAMI_MAX_OPTIMIZERS);
  throw_on_error(kiwami_quality_methods(quality, &options.builder, options.optimizers.data(),
                                        &count, &options.contraction),
                 nullptr);
  options.optimizers.resize(count);
  return options;
}

bool makes_wide_tree(uint32_t builder) {
  return builder == KIWAMI_BUILDER_WIDE_BOTTOM_UP || builder == KIWAMI_BUILDER_WIDE_TOP_DOWN ||
         builder == KIWAMI_BUILDER_WIDE_LINEAR;
}

bool acts_on_wide_tree(uint32_t optimizer) {
  return optimizer == KIWAMI_OPTIMIZER_REORDER_SATO || optimizer == KIWAMI_OPTIMIZER_REORDER_NARY;
}

std::string pipeline_name(const BuildOptions& options) {
  std::string name = kiwami_method_name(KIWAMI_STAGE_BUILDER, options.builder);
  for (const uint32_t method : options.optimizers) {
    name += std::string(" + ") + kiwami_method_name(KIWAMI_STAGE_OPTIMIZER, method);
  }
  const bool is_optimal = options.contraction == KIWAMI_CONTRACTION_OPTIMAL;
  if (!makes_wide_tree(options.builder) || !is_optimal) {
    name += std::string(", ") + kiwami_method_name(KIWAMI_STAGE_CONTRACTION, options.contraction);
  }
  name += options.merge_leaves ? ", merged" : ", unmerged";
  return name + (options.layout == KIWAMI_LAYOUT_COMPACT ? ", compact" : "");
}

Parameter parse_parameter(const std::string& text) {
  const size_t equals = std::min(text.find('='), text.size());
  const std::string name = text.substr(0, equals);
  uint32_t number = parse_whole<uint32_t>(name).value_or(0);
  for (const auto& [known, its_number] : kParameters) {
    if (name == known) number = its_number;
  }
  if (number == 0) {
    throw LibraryError(
        KIWAMI_ERROR_INVALID_ARGUMENT,
        "there is no parameter '" + name + "', expected NAME=VALUE with " + parameter_names());
  }
  const std::string value_text = equals < text.size() ? text.substr(equals + 1) : "";
  const std::optional<double> value = parse_whole<double>(value_text);
  if (!value) {
    throw LibraryError(
        KIWAMI_ERROR_INVALID_ARGUMENT,
        "the value of the parameter '" + name + "' is '" + value_text + "', expected a number");
  }
  return {number, *value};
}

kiwami_file_info file_info_of(const Device& device, const std::string& path) {
  kiwami_load_desc desc;
  throw_on_error(kiwami_load_desc_init(&desc, sizeof desc), device.get());
  desc.path = path.c_str();
  kiwami_file_info info{};
  info.struct_size = sizeof info;
  throw_on_error(kiwami_file_get_info(device.get(), &desc, &info), device.get());
  return info;
}

std::vector<uint32_t> available_isas() {
  const uint32_t available = Device(KIWAMI_ISA_SCALAR, 1).info().isa_available;
  std::vector<uint32_t> isas;
  for (const uint32_t isa : kIsas) {
    if ((available & (1u << isa)) != 0) isas.push_back(isa);
  }
  return isas;
}

uint32_t isa_of_name(const std::string& name) {
  if (name == "auto") return KIWAMI_ISA_AUTO;
  for (const uint32_t isa : kIsas) {
    if (name == kiwami_isa_name(isa)) return isa;
  }
  throw LibraryError(KIWAMI_ERROR_INVALID_ARGUMENT,
                     "the ISA is '" + name + "', expected auto, scalar, sse, avx2 or avx512");
}

}  // namespace kiwami::tools
