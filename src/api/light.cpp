// SPDX-License-Identifier: Apache-2.0
#include "kiwami/light.h"

#include <limits>

#include "api/check.h"
#include "lights/light_sampling.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumDescSize = 8;
constexpr size_t kMinimumInfoSize = 8;

LightTree* object_of(kiwami_light_tree* handle) { return reinterpret_cast<LightTree*>(handle); }
const LightTree* object_of(const kiwami_light_tree* handle) {
  return reinterpret_cast<const LightTree*>(handle);
}
const Device* device_of(const kiwami_light_tree* tree) {
  return tree ? &object_of(tree)->device() : nullptr;
}

kiwami_light_mesh_desc default_mesh() {
  kiwami_light_mesh_desc desc{};
  desc.link_mask = ~uint64_t{0};
  desc.radiance = 1.0f;
  return desc;
}

kiwami_light_instance_desc default_instance() {
  kiwami_light_instance_desc desc{};
  desc.power_scale = 1.0f;
  desc.link_mask = ~uint64_t{0};
  for (int i = 0; i < 3; ++i) desc.local_to_world[5 * i] = 1.0f;
  return desc;
}

constexpr kiwami_light_tree_desc kDefaultTree{};

kiwami_light_query default_query() {
  kiwami_light_query query{};
  query.max_choices = 1;
  query.threshold = 0.5f;
  return query;
}

/// Runs the body of a call on a tree, in the float environment that results are defined in.
template <typename Body>
kiwami_result on_tree(kiwami_light_tree* tree, Body&& body) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    const DefaultFloatEnvironment environment;
    body(*object_of(tree));
  });
}

const CommittedLights& committed_of(const LightTree& tree) {
  if (!tree.committed()) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "tree was never committed, expected a successful kiwami_light_tree_commit before");
  }
  return *tree.committed();
}

kiwami_light_tree_desc read_tree(const kiwami_light_tree_desc* given) {
  if (!given) return kDefaultTree;
  const kiwami_light_tree_desc desc =
      read_descriptor(given, kMinimumDescSize, "desc", kDefaultTree);
  if (desc.width != 0 && desc.width != 2 && desc.width != 4 && desc.width != 8 &&
      desc.width != 16) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.width is %u, expected 0, 2, 4, 8 or 16",
                desc.width);
  }
  if (desc.builder > KIWAMI_LIGHT_BUILDER_OCTANTS) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.builder is %u, expected one of KIWAMI_LIGHT_BUILDER_*", desc.builder);
  }
  if (desc.flags & ~uint32_t{KIWAMI_LIGHT_TREE_WITH_ROULETTE}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.flags is 0x%x, expected KIWAMI_LIGHT_TREE_* bits", desc.flags);
  }
  check_reserved("desc.reserved", desc.reserved);
  if (!(desc.distant_probability >= 0.0f && desc.distant_probability < 1.0f)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.distant_probability is %g, expected at least 0 and below 1",
                static_cast<double>(desc.distant_probability));
  }
  return desc;
}

void check_count(const char* name, uint64_t count, uint64_t limit) {
  if (count <= limit) return;
  throw Error(KIWAMI_ERROR_TOO_LARGE, "%s is %llu, expected at most %llu", name,
              static_cast<unsigned long long>(count), static_cast<unsigned long long>(limit));
}

void check_amount(const char* name, float amount) {
  if (amount >= 0.0f && amount <= std::numeric_limits<float>::max()) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s is %g, expected 0 or more, finite", name,
              static_cast<double>(amount));
}

/// Elements of a mesh, whose pointer may be NULL only if there are none. Returns their stride.
size_t read_stride(const char* name, const void* data, uint64_t stride, size_t size,
                   uint64_t count) {
  if (count != 0) check_array(name, data, static_cast<size_t>(stride), size, count);
  return stride ? static_cast<size_t>(stride) : size;
}

LightMesh read_mesh(const kiwami_light_mesh_desc* given) {
  const kiwami_light_mesh_desc desc =
      read_descriptor(given, kMinimumDescSize, "desc", default_mesh());
  if (desc.flags & ~uint32_t{KIWAMI_LIGHT_TWO_SIDED}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.flags is 0x%x, expected 0 or KIWAMI_LIGHT_TWO_SIDED", desc.flags);
  }
  check_reserved("desc.reserved", desc.reserved);
  check_amount("desc.radiance", desc.radiance);
  check_count("desc.vertex_count", desc.vertex_count, std::numeric_limits<uint32_t>::max());
  check_count("desc.triangle_count", desc.triangle_count, LightTree::kMaxLightCount);
  LightMesh mesh{};
  mesh.vertices = static_cast<const unsigned char*>(desc.vertices);
  mesh.vertex_stride =
      read_stride("desc.vertices", desc.vertices, desc.vertex_stride, 12, desc.vertex_count);
  mesh.indices = static_cast<const unsigned char*>(desc.indices);
  mesh.index_stride = read_stride("desc.indices", desc.indices, desc.index_stride, 12,
                                  desc.indices ? desc.triangle_count : 0);
  mesh.radiances = static_cast<const unsigned char*>(desc.radiances);
  mesh.radiance_stride = read_stride("desc.radiances", desc.radiances, desc.radiance_stride, 4,
                                     desc.radiances ? desc.triangle_count : 0);
  mesh.vertex_count = static_cast<uint32_t>(desc.vertex_count);
  mesh.triangle_count = static_cast<uint32_t>(desc.triangle_count);
  mesh.radiance = desc.radiance;
  mesh.user_id = desc.user_id;
  mesh.user_id_step = desc.user_id_step;
  mesh.is_two_sided = desc.flags != 0;
  mesh.link_mask = desc.link_mask;
  return mesh;
}

LightInstance read_instance(const LightTree& tree, const kiwami_light_instance_desc* given) {
  const kiwami_light_instance_desc desc =
      read_descriptor(given, kMinimumDescSize, "desc", default_instance());
  check_not_null(desc.tree, "desc.tree");
  check_amount("desc.power_scale", desc.power_scale);
  const LightTree& inner = *object_of(desc.tree);
  if (&inner.device() != &tree.device()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.tree is of another device, expected one of the set's");
  }
  if (inner.width() != tree.width()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.tree has the width %u, expected %u, the set's",
                inner.width(), tree.width());
  }
  if (!inner.committed()) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.tree was never committed, expected a successful kiwami_light_tree_commit "
                "before");
  }
  const kiwami_light_tree_info& info = inner.committed()->info();
  if (info.instance_count != 0 || info.distant_count != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.tree has %u instances and %u distant lights and environments, expected none",
                info.instance_count, info.distant_count);
  }
  LightInstance instance{};
  instance.lights = inner.committed();
  std::memcpy(instance.local_to_world, desc.local_to_world, sizeof instance.local_to_world);
  instance.power_scale = desc.power_scale;
  instance.link_mask = desc.link_mask;
  return instance;
}

void check_choices(const kiwami_light_query& query) {
  const bool has_many =
      query.method != KIWAMI_LIGHT_METHOD_TREE && query.method != KIWAMI_LIGHT_METHOD_POWER;
  const uint32_t most = has_many ? KIWAMI_LIGHT_MAX_CHOICES : 1;
  if (query.max_choices < 1 || query.max_choices > most) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.max_choices is %u, expected at least 1 and at most %u for this method",
                query.max_choices, most);
  }
  if (!(query.threshold >= 0.0f && query.threshold <= 1.0f)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "query.threshold is %g, expected 0 to 1",
                static_cast<double>(query.threshold));
  }
}

void check_roulette(const kiwami_light_query& query, const CommittedLights& lights) {
  if (is_roulette(query.method) && !lights.has_roulette()) {
    throw Error(KIWAMI_ERROR_INVALID_STATE,
                "query.method is %u, a roulette, but the set was made without "
                "KIWAMI_LIGHT_TREE_WITH_ROULETTE, expected it in the flags of its description",
                query.method);
  }
}

void check_lobes(const kiwami_light_query& query) {
  if (query.lobe > KIWAMI_LIGHT_LOBE_GLOSSY) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.lobe is %u, expected one of KIWAMI_LIGHT_LOBE_*", query.lobe);
  }
  if (query.order > KIWAMI_LIGHT_ORDER_SCRAMBLED) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.order is %u, expected one of KIWAMI_LIGHT_ORDER_*", query.order);
  }
  check_amount("query.reach", query.reach);
  if (query.lobe == KIWAMI_LIGHT_LOBE_GLOSSY) {
    check_array("query.lobes", query.lobes, static_cast<size_t>(query.lobe_stride),
                sizeof(kiwami_light_lobe), 1);
  }
}

void check_sequence(const kiwami_light_query& query, bool is_sampled) {
  if (query.sequence > KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.sequence is %u, expected one of KIWAMI_LIGHT_SEQUENCE_*", query.sequence);
  }
  if (query.sequence == KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE && is_sampled) {
    check_array("query.pixels", query.pixels, static_cast<size_t>(query.pixel_stride),
                sizeof(kiwami_light_pixel), 1);
  }
}

kiwami_light_query read_query(const kiwami_light_query* given) {
  if (!given) return default_query();
  const kiwami_light_query query =
      read_descriptor(given, kMinimumDescSize, "query", default_query());
  if (query.flags & ~uint32_t{KIWAMI_LIGHT_QUERY_CALLING_THREAD}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.flags is 0x%x, expected KIWAMI_LIGHT_QUERY_* bits", query.flags);
  }
  if (query.method > KIWAMI_LIGHT_METHOD_ROULETTE) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "query.method is %u, expected one of KIWAMI_LIGHT_METHOD_*", query.method);
  }
  check_choices(query);
  check_lobes(query);
  return query;
}

LightMethod method_of(const kiwami_light_query& query) {
  // With room for one choice nothing can be split.
  const bool has_tree = query.method != KIWAMI_LIGHT_METHOD_POWER;
  const uint32_t method =
      has_tree && query.max_choices == 1 ? uint32_t{KIWAMI_LIGHT_METHOD_TREE} : query.method;
  LightMethod result{method, query.flags != 0, {}};
  result.rules = {method,
                  query.lobe,
                  query.order,
                  static_cast<double>(query.reach),
                  query.max_choices,
                  query.sequence,
                  query.sequence_seed};
  return result;
}

/// (1 / (1 + deviation))^(1/4) below the threshold, as a limit of the deviation.
double split_limit_of(float threshold) {
  const double square = static_cast<double>(threshold) * static_cast<double>(threshold);
  const double fourth = square * square;
  return fourth > 0.0 ? 1.0 / fourth - 1.0 : std::numeric_limits<double>::infinity();
}

size_t stride_or(size_t stride, size_t size) { return stride ? stride : size; }

const unsigned char* lobes_of(const kiwami_light_query& query) {
  return query.lobe == KIWAMI_LIGHT_LOBE_GLOSSY
             ? reinterpret_cast<const unsigned char*>(query.lobes)
             : nullptr;
}
const unsigned char* pixels_of(const kiwami_light_query& query) {
  return query.sequence == KIWAMI_LIGHT_SEQUENCE_BLUE_NOISE
             ? reinterpret_cast<const unsigned char*>(query.pixels)
             : nullptr;
}
size_t lobe_stride_of(const kiwami_light_query& query) {
  return stride_or(static_cast<size_t>(query.lobe_stride), sizeof(kiwami_light_lobe));
}

}  // namespace

extern "C" {

kiwami_result kiwami_light_tree_desc_init(kiwami_light_tree_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", kDefaultTree); });
}

kiwami_result kiwami_light_mesh_desc_init(kiwami_light_mesh_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", default_mesh()); });
}

kiwami_result kiwami_light_instance_desc_init(kiwami_light_instance_desc* desc, size_t size) {
  return guarded(
      nullptr, [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", default_instance()); });
}

kiwami_result kiwami_light_query_init(kiwami_light_query* query, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(query, size, kMinimumDescSize, "query", default_query()); });
}

kiwami_result kiwami_light_tree_create(kiwami_device* device, const kiwami_light_tree_desc* desc,
                                       kiwami_light_tree** tree) {
  if (tree) *tree = nullptr;
  return guarded(kiwami::api::object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(tree, "tree");
    *tree = reinterpret_cast<kiwami_light_tree*>(
        LightTree::create(*kiwami::api::object_of(device), read_tree(desc)));
  });
}

void kiwami_light_tree_retain(kiwami_light_tree* tree) {
  if (tree) object_of(tree)->retain();
}

void kiwami_light_tree_release(kiwami_light_tree* tree) {
  if (tree) object_of(tree)->release();
}

kiwami_result kiwami_light_tree_add_lights(kiwami_light_tree* tree, const kiwami_light* lights,
                                           size_t stride, size_t count, uint32_t* first_id) {
  return on_tree(tree, [&](LightTree& object) {
    if (count != 0) check_array("lights", lights, stride, sizeof(kiwami_light), count);
    const uint32_t first = object.add_lights(reinterpret_cast<const unsigned char*>(lights),
                                             stride_or(stride, sizeof(kiwami_light)), count);
    if (first_id) *first_id = first;
  });
}

kiwami_result kiwami_light_tree_add_mesh(kiwami_light_tree* tree,
                                         const kiwami_light_mesh_desc* desc, uint32_t* first_id) {
  return on_tree(tree, [&](LightTree& object) {
    const uint32_t first = object.add_mesh(read_mesh(desc));
    if (first_id) *first_id = first;
  });
}

kiwami_result kiwami_light_tree_add_instance(kiwami_light_tree* tree,
                                             const kiwami_light_instance_desc* desc,
                                             uint32_t* instance_id) {
  return on_tree(tree, [&](LightTree& object) {
    const uint32_t number = object.add_instance(read_instance(object, desc));
    if (instance_id) *instance_id = number;
  });
}

kiwami_result kiwami_light_tree_set_lights(kiwami_light_tree* tree, uint32_t first,
                                           const kiwami_light* lights, size_t stride,
                                           size_t count) {
  return on_tree(tree, [&](LightTree& object) {
    if (count != 0) check_array("lights", lights, stride, sizeof(kiwami_light), count);
    object.set_lights(first, reinterpret_cast<const unsigned char*>(lights),
                      stride_or(stride, sizeof(kiwami_light)), count);
  });
}

kiwami_result kiwami_light_tree_set_powers(kiwami_light_tree* tree, uint32_t first,
                                           const float* powers, size_t stride, size_t count) {
  return on_tree(tree, [&](LightTree& object) {
    if (count != 0) check_array("powers", powers, stride, sizeof(float), count);
    object.set_powers(first, reinterpret_cast<const unsigned char*>(powers),
                      stride_or(stride, sizeof(float)), count);
  });
}

kiwami_result kiwami_light_tree_set_instance(kiwami_light_tree* tree, uint32_t instance_id,
                                             const kiwami_light_instance_desc* desc) {
  return on_tree(tree, [&](LightTree& object) {
    object.set_instance(instance_id, read_instance(object, desc));
  });
}

kiwami_result kiwami_light_tree_commit(kiwami_light_tree* tree) {
  return on_tree(tree, [](LightTree& object) { object.commit(); });
}

kiwami_result kiwami_light_tree_refit(kiwami_light_tree* tree) {
  return on_tree(tree, [](LightTree& object) { object.refit(); });
}

kiwami_result kiwami_light_tree_get_info(const kiwami_light_tree* tree,
                                         kiwami_light_tree_info* info) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    committed_of(*object_of(tree));
    write_info(info, kMinimumInfoSize, "info", object_of(tree)->info());
  });
}

kiwami_result kiwami_light_sample(const kiwami_light_tree* tree,
                                  const kiwami_light_receiver* receivers, size_t receiver_stride,
                                  kiwami_light_choice* choices, size_t choice_stride, size_t count,
                                  const kiwami_light_query* query) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    const LightTree& object = *object_of(tree);
    const kiwami_light_query checked = read_query(query);
    check_roulette(checked, committed_of(object));
    check_sequence(checked, true);
    if (count == 0) return;
    if (object.device().validates_arguments()) {
      check_array("receivers", receivers, receiver_stride, sizeof(kiwami_light_receiver), count);
      check_count("count", count, std::numeric_limits<size_t>::max() / checked.max_choices);
      check_array("choices", choices, choice_stride, sizeof(kiwami_light_choice),
                  count * checked.max_choices);
    }
    const LightBatch batch{
        reinterpret_cast<const unsigned char*>(receivers),
        stride_or(receiver_stride, sizeof(kiwami_light_receiver)),
        nullptr,
        0,
        reinterpret_cast<unsigned char*>(choices),
        stride_or(choice_stride, sizeof(kiwami_light_choice)),
        count,
        checked.max_choices,
        split_limit_of(checked.threshold),
        checked.method == KIWAMI_LIGHT_METHOD_LIGHTCUTS,
        lobes_of(checked),
        lobe_stride_of(checked),
        pixels_of(checked),
        stride_or(static_cast<size_t>(checked.pixel_stride), sizeof(kiwami_light_pixel))};
    sample_lights(object, method_of(checked), batch);
  });
}

kiwami_result kiwami_light_pdf(const kiwami_light_tree* tree,
                               const kiwami_light_receiver* receivers, size_t receiver_stride,
                               const kiwami_light_name* lights, size_t light_stride,
                               float* probabilities, size_t probability_stride, size_t count,
                               const kiwami_light_query* query) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    const LightTree& object = *object_of(tree);
    const kiwami_light_query checked = read_query(query);
    check_roulette(checked, committed_of(object));
    check_sequence(checked, false);
    if (count == 0) return;
    if (object.device().validates_arguments()) {
      check_array("receivers", receivers, receiver_stride, sizeof(kiwami_light_receiver), count);
      check_array("lights", lights, light_stride, sizeof(kiwami_light_name), count);
      check_array("probabilities", probabilities, probability_stride, sizeof(float), count);
    }
    const LightBatch batch{reinterpret_cast<const unsigned char*>(receivers),
                           stride_or(receiver_stride, sizeof(kiwami_light_receiver)),
                           reinterpret_cast<const unsigned char*>(lights),
                           stride_or(light_stride, sizeof(kiwami_light_name)),
                           reinterpret_cast<unsigned char*>(probabilities),
                           stride_or(probability_stride, sizeof(float)),
                           count,
                           checked.max_choices,
                           split_limit_of(checked.threshold),
                           checked.method == KIWAMI_LIGHT_METHOD_LIGHTCUTS,
                           lobes_of(checked),
                           lobe_stride_of(checked)};
    find_light_probabilities(object, method_of(checked), batch);
  });
}

}  // extern "C"
