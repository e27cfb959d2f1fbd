// SPDX-License-Identifier: Apache-2.0
#include "kiwami/binary_tree.h"

#include "api/check.h"
#include "core/binary_tree.h"

using namespace kiwami;
using namespace kiwami::api;

namespace {

constexpr size_t kMinimumStructSize = 8;

BinaryTree* object_of(kiwami_binary_tree* handle) { return reinterpret_cast<BinaryTree*>(handle); }
const BinaryTree* object_of(const kiwami_binary_tree* handle) {
  return reinterpret_cast<const BinaryTree*>(handle);
}
const Device* device_of(const kiwami_binary_tree* tree) {
  return tree ? &object_of(tree)->device() : nullptr;
}

}  // namespace

extern "C" {

kiwami_result kiwami_binary_tree_create(const kiwami_bvh* bvh, uint32_t layout,
                                        kiwami_binary_tree** tree) {
  if (tree) *tree = nullptr;
  return guarded(kiwami::api::device_of(bvh), [&] {
    check_not_null(bvh, "bvh");
    check_not_null(tree, "tree");
    if (layout > KIWAMI_BINARY_LAYOUT_DUAL_SPLIT) {
      throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                  "layout is %u, expected one of KIWAMI_BINARY_LAYOUT_*", layout);
    }
    BinaryTree* const made = BinaryTree::create(*kiwami::api::object_of(bvh), layout);
    *tree = reinterpret_cast<kiwami_binary_tree*>(made);
  });
}

void kiwami_binary_tree_retain(kiwami_binary_tree* tree) {
  if (tree) object_of(tree)->retain();
}

void kiwami_binary_tree_release(kiwami_binary_tree* tree) {
  if (tree) object_of(tree)->release();
}

kiwami_result kiwami_binary_tree_get_info(const kiwami_binary_tree* tree,
                                          kiwami_binary_tree_info* info) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    write_info(info, kMinimumStructSize, "info", object_of(tree)->info());
  });
}

kiwami_result kiwami_binary_tree_validate(const kiwami_binary_tree* tree) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    object_of(tree)->validate();
  });
}

kiwami_result kiwami_binary_tree_closest_hit(const kiwami_binary_tree* tree, const kiwami_ray* rays,
                                             size_t ray_stride, kiwami_hit* hits, size_t hit_stride,
                                             size_t count, kiwami_binary_visits* visits) {
  return guarded(device_of(tree), [&] {
    check_not_null(tree, "tree");
    if (visits) check_struct_size("visits.struct_size", visits->struct_size, kMinimumStructSize);
    const BinaryTree& object = *object_of(tree);
    if (object.device().validates_arguments() && count != 0) {
      check_array("rays", rays, ray_stride, sizeof(kiwami_ray), count);
      check_array("hits", hits, hit_stride, sizeof(kiwami_hit), count);
    }
    const BinaryTreeCounters counters = object.trace(
        {reinterpret_cast<const unsigned char*>(rays), ray_stride ? ray_stride : sizeof(kiwami_ray),
         reinterpret_cast<unsigned char*>(hits), hit_stride ? hit_stride : sizeof(kiwami_hit),
         count});
    if (!visits) return;
    write_info(visits, kMinimumStructSize, "visits",
               kiwami_binary_visits{0, 0, counters.node_visits, counters.plane_tests,
                                    counters.leaf_visits});
  });
}

}  // extern "C"
