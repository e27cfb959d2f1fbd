// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bvh.h"

#include "api/check.h"
#include "core/visits.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumInfoSize = 8;

constexpr size_t kMinimumDescSize = 8;
constexpr double kGreatestCost = 1e6;

constexpr kiwami_bvh_measure_desc kDefaultMeasureDesc = {0, 0, 1.0, 1.0, 0, 0};

/// Throws unless the tree has all of count elements from first on.
void check_range(const char* name, size_t first, size_t count, size_t size) {
  if (first <= size && count <= size - first) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
              "first is %zu and count is %zu, expected some of the %zu %s of the tree", first,
              count, size, name);
}

/// Writes count elements, element_of(i) each, to an array of the caller.
template <typename T, typename ElementOf>
void copy_out(const char* name, T* target, size_t stride, size_t count, ElementOf&& element_of) {
  if (count == 0) return;
  check_array(name, target, stride, sizeof(T), count);
  const size_t step = stride ? stride : sizeof(T);
  auto* const bytes = reinterpret_cast<unsigned char*>(target);
  for (size_t i = 0; i < count; ++i) {
    const T element = element_of(i);
    std::memcpy(bytes + i * step, &element, sizeof element);
  }
}

constexpr kiwami_bvh_desc kDefaultBvhDesc{};
constexpr uint64_t kMaxBoxCount = 0x7FFFFFFF;

BoxArray read_box_array(const char* name, const void* boxes, size_t stride, size_t count) {
  if (count != 0) check_array(name, boxes, stride, sizeof(Bounds), count);
  return {static_cast<const unsigned char*>(boxes), stride ? stride : sizeof(Bounds), count};
}

uint32_t read_width(uint32_t width, const Device& device) {
  if (width == 0) return device.info().default_bvh_width;
  if (width == 2 || width == 4 || width == 8 || width == 16) return width;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.width is %u, expected 0, 2, 4, 8 or 16", width);
}

SceneParameters read_parameters(const kiwami_bvh_desc& desc) {
  if (desc.parameter_count != 0) check_not_null(desc.parameters, "desc.parameters");
  if (desc.optimizer_count != 0) check_not_null(desc.optimizers, "desc.optimizers");
  SceneParameters parameters;
  for (uint64_t i = 0; i < desc.parameter_count; ++i) {
    const kiwami_parameter_value& given = desc.parameters[i];
    check_reserved("desc.parameters[].reserved", given.reserved);
    if (given.parameter == KIWAMI_PARAMETER_BVH_WIDTH) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "desc.parameters[%llu] is KIWAMI_PARAMETER_BVH_WIDTH, expected desc.width in its "
                  "place",
                  static_cast<unsigned long long>(i));
    }
    parameters.set(given.parameter, given.value);
  }
  parameters.set_optimizers({desc.optimizers, static_cast<size_t>(desc.optimizer_count)});
  return parameters;
}

BvhPlan read_plan(const kiwami_bvh_desc* given, Device& device) {
  const kiwami_bvh_desc desc = read_descriptor(given, kMinimumDescSize, "desc", kDefaultBvhDesc);
  Geometry* const geometry = object_of(desc.geometry);
  if (geometry && (desc.boxes || desc.box_count != 0)) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc has boxes and a geometry, expected one of them");
  }
  if (geometry && &geometry->device() != &device) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.geometry is of another device, expected one of device");
  }
  if (geometry && geometry->kind() != GeometryKind::kTriangleMesh) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "desc.geometry is no triangle mesh, expected one, or boxes");
  }
  if (desc.box_count > kMaxBoxCount) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.box_count is %llu, expected at most %llu",
                static_cast<unsigned long long>(desc.box_count),
                static_cast<unsigned long long>(kMaxBoxCount));
  }
  return {read_width(desc.width, device),
          read_box_array("desc.boxes", desc.boxes, static_cast<size_t>(desc.box_stride),
                         static_cast<size_t>(desc.box_count)),
          static_cast<TriangleMesh*>(geometry), read_parameters(desc)};
}

void check_cost(const char* name, double cost) {
  if (cost >= 0.0 && cost <= kGreatestCost) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s is %g, expected 0 to %g", name, cost,
              kGreatestCost);
}

kiwami_bvh_measure_desc read_measure_desc(const kiwami_bvh_measure_desc* desc) {
  if (!desc) return kDefaultMeasureDesc;
  const kiwami_bvh_measure_desc checked =
      read_descriptor(desc, kMinimumDescSize, "desc", kDefaultMeasureDesc);
  if (checked.flags & ~uint32_t{KIWAMI_MEASURE_WITHOUT_EPO}) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected KIWAMI_MEASURE_* bits",
                checked.flags);
  }
  check_cost("desc.node_cost", checked.node_cost);
  check_cost("desc.leaf_cost", checked.leaf_cost);
  check_reserved("desc.reserved", checked.reserved);
  return checked;
}

}  // namespace

extern "C" {

kiwami_result kiwami_scene_get_bvh(const kiwami_scene* scene, kiwami_bvh** bvh) {
  if (bvh) *bvh = nullptr;
  return guarded(device_of(scene), [&] {
    CommittedScene& committed = committed_of(scene);
    check_not_null(bvh, "bvh");
    if (!committed.meshes().empty()) {
      throw Error(
          KIWAMI_ERROR_INVALID_STATE,
          "the scene was committed with KIWAMI_PARAMETER_TWO_LEVEL, so that each mesh has a "
          "tree, expected one tree");
    }
    const DefaultFloatEnvironment environment;
    *bvh = reinterpret_cast<kiwami_bvh*>(Bvh::create(object_of(scene)->device(), committed));
  });
}

kiwami_result kiwami_bvh_desc_init(kiwami_bvh_desc* desc, size_t size) {
  return guarded(nullptr,
                 [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", kDefaultBvhDesc); });
}

kiwami_result kiwami_bvh_build(kiwami_device* device, const kiwami_bvh_desc* desc,
                               kiwami_bvh** bvh) {
  if (bvh) *bvh = nullptr;
  return guarded(object_of(device), [&] {
    check_not_null(device, "device");
    check_not_null(bvh, "bvh");
    const DefaultFloatEnvironment environment;
    const BvhPlan plan = read_plan(desc, *object_of(device));
    *bvh = reinterpret_cast<kiwami_bvh*>(Bvh::create(*object_of(device), plan));
  });
}

kiwami_result kiwami_bvh_refit(kiwami_bvh* bvh, const void* boxes, size_t stride, size_t count) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const DefaultFloatEnvironment environment;
    object_of(bvh)->refit(read_box_array("boxes", boxes, stride, count));
  });
}

kiwami_result kiwami_bvh_validate(const kiwami_bvh* bvh) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const DefaultFloatEnvironment environment;
    object_of(bvh)->validate();
  });
}

void kiwami_bvh_retain(kiwami_bvh* bvh) {
  if (bvh) object_of(bvh)->retain();
}

void kiwami_bvh_release(kiwami_bvh* bvh) {
  if (bvh) object_of(bvh)->release();
}

kiwami_result kiwami_bvh_get_info(const kiwami_bvh* bvh, kiwami_bvh_info* info) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    write_info(info, kMinimumInfoSize, "info", object_of(bvh)->info());
  });
}

kiwami_result kiwami_bvh_get_nodes(const kiwami_bvh* bvh, size_t first, size_t count,
                                   kiwami_bvh_node* nodes, size_t stride) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const Bvh& tree = *object_of(bvh);
    check_range("nodes", first, count, tree.nodes().size());
    copy_out("nodes", nodes, stride, count, [&](size_t i) { return tree.nodes()[first + i]; });
  });
}

kiwami_result kiwami_bvh_get_primitives(const kiwami_bvh* bvh, size_t first, size_t count,
                                        kiwami_bvh_primitive* primitives, size_t stride) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const Bvh& tree = *object_of(bvh);
    check_range("primitives", first, count, tree.primitive_count());
    copy_out("primitives", primitives, stride, count,
             [&](size_t i) { return tree.primitive(first + i); });
  });
}

kiwami_result kiwami_bvh_measure_desc_init(kiwami_bvh_measure_desc* desc, size_t size) {
  return guarded(
      nullptr, [&] { init_descriptor(desc, size, kMinimumDescSize, "desc", kDefaultMeasureDesc); });
}

kiwami_result kiwami_bvh_measure(const kiwami_bvh* bvh, const kiwami_bvh_measure_desc* desc,
                                 kiwami_bvh_measures* measures, kiwami_bvh_node_measures* nodes,
                                 size_t stride) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const DefaultFloatEnvironment environment;
    const BvhMeasures measured = object_of(bvh)->measure(read_measure_desc(desc));
    if (measures) write_info(measures, kMinimumInfoSize, "measures", measured.totals);
    if (nodes) {
      copy_out("nodes", nodes, stride, measured.nodes.size(),
               [&](size_t i) { return measured.nodes[i]; });
    }
  });
}

kiwami_result kiwami_scene_count_visits(const kiwami_scene* scene, const kiwami_ray* rays,
                                        size_t ray_stride, size_t count, uint32_t query,
                                        kiwami_visits* visits, kiwami_ray_visits* each,
                                        size_t each_stride) {
  return guarded(device_of(scene), [&] {
    const CommittedScene& committed = committed_of(scene);
    if (query != KIWAMI_COUNT_CLOSEST_HIT && query != KIWAMI_COUNT_ANY_HIT) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "query is %u, expected one of KIWAMI_COUNT_*",
                  query);
    }
    if (count != 0) check_array("rays", rays, ray_stride, sizeof(kiwami_ray), count);
    if (count != 0 && each) {
      check_array("each", each, each_stride, sizeof(kiwami_ray_visits), count);
    }
    const kiwami_visits counted = count_visits(
        committed, rays, ray_stride ? ray_stride : sizeof(kiwami_ray), count,
        query == KIWAMI_COUNT_ANY_HIT, each, each_stride ? each_stride : sizeof(kiwami_ray_visits));
    if (visits) write_info(visits, kMinimumInfoSize, "visits", counted);
  });
}

}  // extern "C"
