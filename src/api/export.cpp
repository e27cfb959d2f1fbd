// SPDX-License-Identifier: Apache-2.0
#include "kiwami/export.h"

#include "api/check.h"
#include "bvh/export_tree.h"
#include "math/float_environment.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

std::span<const kiwami_bvh_node> nodes_of(const Bvh& bvh) {
  return {bvh.nodes().data(), bvh.nodes().size()};
}

void check_room(const char* name, size_t room, size_t needed) {
  if (room >= needed) return;
  throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "%s is %zu, expected at least %zu", name, room,
              needed);
}

}  // namespace

extern "C" {

kiwami_result kiwami_bvh_export_counts(const kiwami_bvh* bvh, uint32_t format, size_t* node_count,
                                       size_t* primitive_count) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const Bvh& tree = *object_of(bvh);
    const size_t count = exported_node_count(nodes_of(tree), format);
    if (node_count) *node_count = count;
    if (primitive_count) *primitive_count = tree.primitive_count();
  });
}

kiwami_result kiwami_bvh_export(const kiwami_bvh* bvh, uint32_t format, void* nodes,
                                size_t node_bytes, kiwami_bvh_primitive* primitives,
                                size_t primitive_count) {
  return guarded(device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    const DefaultFloatEnvironment environment;
    const Bvh& tree = *object_of(bvh);
    const size_t needed = exported_node_count(nodes_of(tree), format);
    check_room("node_bytes", node_bytes, needed * export_format(format).node_size);
    check_room("primitive_count", primitive_count, tree.primitive_count());
    if (needed == 0) return;
    check_not_null(nodes, "nodes");
    check_not_null(primitives, "primitives");
    const ExportedTree exported = export_tree(nodes_of(tree), format, tree.device().memory());
    std::memcpy(nodes, exported.nodes.data(), exported.nodes.bytes());
    auto* const names = reinterpret_cast<unsigned char*>(primitives);
    for (size_t i = 0; i < exported.positions.size(); ++i) {
      const kiwami_bvh_primitive name = tree.primitive(exported.positions[i]);
      std::memcpy(names + i * sizeof name, &name, sizeof name);
    }
  });
}

}  // extern "C"
