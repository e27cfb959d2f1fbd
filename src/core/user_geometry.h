// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/geometry.h"
#include "core/part_tree.h"
#include "kiwami/user_geometry.h"
#include "wide/user_source.h"

namespace kiwami {

/// Primitives that the caller's functions bound and intersect.
class UserGeometry final : public Geometry {
 public:
  /// Throws Error(INVALID_ARGUMENT, TOO_LARGE or OUT_OF_MEMORY).
  static UserGeometry* create(Device& device, const kiwami_user_geometry_desc& desc);

  UserGeometry(Device& device, const kiwami_user_geometry_desc& desc);
  ~UserGeometry();

  uint32_t count() const { return static_cast<uint32_t>(desc_.count); }
  size_t copied_bytes() const override { return 0; }

  /// Writes the boxes of count primitives from first on. Throws Error(CALLBACK).
  void bounds_of(uint32_t first, uint32_t count, Bounds* boxes) const;

  /// The primitives as a part of a scene: their running ids begin at first_id.
  UserView view(uint32_t first_id, uint32_t geometry_id) const {
    return {desc_.intersect, desc_.user, count(), first_id, geometry_id, mask()};
  }

 private:
  void end(Memory& memory) noexcept override { destroy_object(memory, this); }

  kiwami_user_geometry_desc desc_;
};

/// The user geometries of a scene, and the tree over their primitives.
class UserPart {
 public:
  UserPart() = default;
  UserPart(const UserPart&) = delete;
  UserPart& operator=(const UserPart&) = delete;

  /// Of those among count geometries that are user geometries, by rising geometry_id. Throws Error.
  void build(const AttachedGeometry* geometries, size_t count, const PartPlan& plan);

  /// Points into this object.
  ScenePart view() const;
  const PartTree& tree() const { return tree_; }
  /// Primitives of all these geometries, skipped ones included.
  size_t numbered_count() const { return numbered_count_; }

 private:
  Array<BuildPrimitive> collect(const Array<const UserGeometry*>& geometries,
                                const PartPlan& plan) const;

  Array<UserView> views_;
  UserSource source_{};
  size_t numbered_count_ = 0;
  PartTree tree_;
};

}  // namespace kiwami
