// SPDX-License-Identifier: Apache-2.0
#include "core/user_geometry.h"

#include <algorithm>
#include <limits>

#include "core/collect_boxes.h"
#include "core/error.h"

namespace kiwami {
namespace {

constexpr uint64_t kMaxPrimitiveCount = std::numeric_limits<int32_t>::max();
/// Ids have 32 bits, of which the highest one stands for none.
constexpr uint64_t kMaxNumberedCount = 0xFFFFFFFEu;
/// Primitives that one call of a callback bounds.
constexpr uint32_t kBatch = 256;

using ull = unsigned long long;

void check(const kiwami_user_geometry_desc& desc) {
  if (desc.flags != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.flags is 0x%x, expected 0", desc.flags);
  }
  if (desc.reserved != 0) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.reserved is %u, expected 0", desc.reserved);
  }
  if (desc.count > kMaxPrimitiveCount) {
    throw Error(KIWAMI_ERROR_TOO_LARGE, "desc.count is %llu, expected at most %llu",
                ull{desc.count}, ull{kMaxPrimitiveCount});
  }
  if (!desc.bounds || !desc.intersect) {
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT, "desc.%s is NULL, expected a function",
                desc.bounds ? "intersect" : "bounds");
  }
}

/// Comparisons with NaN are false.
bool is_box(const Bounds& box) {
  for (int axis = 0; axis < 3; ++axis) {
    if (!(-KIWAMI_MAX_COORDINATE <= box.lower[axis] && box.lower[axis] <= box.upper[axis] &&
          box.upper[axis] <= KIWAMI_MAX_COORDINATE)) {
      return false;
    }
  }
  return true;
}

}  // namespace

UserGeometry* UserGeometry::create(Device& device, const kiwami_user_geometry_desc& desc) {
  check(desc);
  return make_object<UserGeometry>(device.memory(), device, desc);
}

UserGeometry::UserGeometry(Device& device, const kiwami_user_geometry_desc& desc)
    : Geometry(device, GeometryKind::kUser, desc.mask), desc_(desc) {}

UserGeometry::~UserGeometry() {
  if (desc_.destroy) desc_.destroy(desc_.user);
}

void UserGeometry::bounds_of(uint32_t first, uint32_t count, Bounds* boxes) const {
  static_assert(sizeof(Bounds) == 6 * sizeof(float));
  std::fill_n(boxes, count, Bounds::empty());
  const int32_t result = desc_.bounds(desc_.user, first, count, &boxes->lower.x);
  if (result < 0) {
    throw Error(KIWAMI_ERROR_CALLBACK,
                "the bounds callback returned %d for %u primitives from %u on, expected 0 or more",
                result, count, first);
  }
}

void UserPart::build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan) {
  views_ = Array<UserView>(plan.memory, count);
  Array<const UserGeometry*> own(plan.memory, count);
  uint64_t next_id = 0;
  size_t used = 0;
  for (size_t i = 0; i < count; ++i) {
    if (geometries[i].geometry->kind() != GeometryKind::kUser) continue;
    const auto& geometry = static_cast<const UserGeometry&>(*geometries[i].geometry);
    if (geometry.count() == 0) continue;
    own[used] = &geometry;
    views_[used++] = geometry.view(static_cast<uint32_t>(next_id), geometries[i].geometry_id);
    next_id += geometry.count();
    if (next_id > kMaxNumberedCount) {
      throw Error(KIWAMI_ERROR_TOO_LARGE,
                  "the scene has %llu user primitives up to geometry %u, expected at most %llu",
                  ull{next_id}, geometries[i].geometry_id, ull{kMaxNumberedCount});
    }
  }
  views_.shrink(used);
  numbered_count_ = static_cast<size_t>(next_id);
  source_ = {views_.data(), static_cast<uint32_t>(used)};
  if (used != 0) tree_ = build_part_tree(collect(own, plan), plan);
}

Array<BuildPrimitive> UserPart::collect(const Array<const UserGeometry*>& geometries,
                                        const PartPlan& plan) const {
  const auto make_block = [&](size_t begin, size_t end, BuildPrimitive* made) {
    size_t made_count = 0;
    size_t geometry = 0;
    for (size_t id = begin; id < end;) {
      while (id - views_[geometry].first_id >= views_[geometry].count) ++geometry;
      const uint32_t first = static_cast<uint32_t>(id) - views_[geometry].first_id;
      const uint32_t batch = static_cast<uint32_t>(
          std::min({size_t{kBatch}, end - id, size_t{views_[geometry].count - first}}));
      Bounds boxes[kBatch];
      geometries[geometry]->bounds_of(first, batch, boxes);
      for (uint32_t i = 0; i < batch; ++i) {
        if (!is_box(boxes[i])) continue;
        made[made_count++] = {boxes[i].lower, static_cast<uint32_t>(id) + i, boxes[i].upper, 0};
      }
      id += batch;
    }
    return made_count;
  };
  return collect_blocks(numbered_count_, plan.memory, plan.parallel, make_block);
}

ScenePart UserPart::view() const {
  return {PartKind::kUser, tree_.tree.view, &source_, std::numeric_limits<float>::infinity(), 0.0f};
}

}  // namespace kiwami
