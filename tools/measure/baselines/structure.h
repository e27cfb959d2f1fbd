// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "measure/baselines/triangle_test.h"

namespace kiwami::tools {

/// What rays cost in a structure.
struct StepCounts {
  uint64_t steps = 0;  ///< inner nodes or cells that were entered
  uint64_t triangle_tests = 0;
};

/// A textbook acceleration structure without vector instructions, which the library is measured
/// against. All use the same triangle test. It is no part of the library.
class Structure {
 public:
  virtual ~Structure() = default;
  virtual void closest_hits(std::span<const kiwami_ray> rays,
                            std::span<BaselineHit> hits) const = 0;
  virtual void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const = 0;
  virtual StepCounts count(std::span<const kiwami_ray> rays, bool any_hit) const = 0;
  virtual uint64_t bytes() const = 0;
};

std::unique_ptr<Structure> build_uniform_grid(std::span<const Corners> triangles);
std::unique_ptr<Structure> build_kd_tree(std::span<const Corners> triangles);
std::unique_ptr<Structure> build_bounding_interval_hierarchy(std::span<const Corners> triangles);
std::unique_ptr<Structure> build_binary_bvh(std::span<const Corners> triangles);

/// A structure that can be chosen by name: "grid", "kd_tree", "bih" or "bvh".
struct NamedStructure {
  const char* name;
  std::unique_ptr<Structure> (*build)(std::span<const Corners> triangles);
};
constexpr NamedStructure kStructures[] = {{"grid", build_uniform_grid},
                                          {"kd_tree", build_kd_tree},
                                          {"bih", build_bounding_interval_hierarchy},
                                          {"bvh", build_binary_bvh}};

/// What a traversal tells of itself: nothing, or counts.
struct NoProbe {
  void on_step() {}
  void on_triangle() {}
};
struct CountingProbe {
  StepCounts counts;
  void on_step() { ++counts.steps; }
  void on_triangle() { ++counts.triangle_tests; }
};

/// The entrances over Derived::trace<kAnyHit>(ray, hit, probe), which sets `hit` where it finds
/// one.
template <typename Derived>
class StructureOf : public Structure {
 public:
  void closest_hits(std::span<const kiwami_ray> rays, std::span<BaselineHit> hits) const override {
    NoProbe probe;
    for (size_t i = 0; i < rays.size(); ++i) hits[i] = find<false>(rays[i], probe);
  }

  void any_hits(std::span<const kiwami_ray> rays, std::span<uint8_t> occluded) const override {
    NoProbe probe;
    for (size_t i = 0; i < rays.size(); ++i) {
      occluded[i] = find<true>(rays[i], probe).triangle != KIWAMI_INVALID_ID ? 1 : 0;
    }
  }

  StepCounts count(std::span<const kiwami_ray> rays, bool any_hit) const override {
    CountingProbe probe;
    for (const kiwami_ray& ray : rays) {
      if (any_hit) {
        find<true>(ray, probe);
      } else {
        find<false>(ray, probe);
      }
    }
    return probe.counts;
  }

 private:
  template <bool kAnyHit, typename Probe>
  BaselineHit find(const kiwami_ray& ray, Probe& probe) const {
    BaselineHit hit = no_hit(ray);
    static_cast<const Derived*>(this)->template trace<kAnyHit>(ray, hit, probe);
    return hit;
  }
};

/// A ray as the structures want it.
struct PreparedRay {
  Vec3 origin;
  Vec3 direction;
  float inverse[3];  ///< of the direction; large but finite where that is 0
  bool backwards[3];
  float tmin;

  explicit PreparedRay(const kiwami_ray& ray)
      : origin{ray.origin_x, ray.origin_y, ray.origin_z},
        direction{ray.direction_x, ray.direction_y, ray.direction_z},
        tmin(ray.tmin) {
    constexpr float kLeast = 1e-30f;
    for (int axis = 0; axis < 3; ++axis) {
      const float component = direction[axis];
      const float safe =
          std::abs(component) < kLeast ? std::copysign(kLeast, component) : component;
      inverse[axis] = 1.0f / safe;
      backwards[axis] = std::signbit(component);
    }
  }
};

/// The last triangles that a ray was tested against, where those that reach into several cells are
/// met again and again.
class Mailbox {
 public:
  Mailbox() { numbers_.fill(KIWAMI_INVALID_ID); }
  bool has_seen(uint32_t number) {
    return std::exchange(numbers_[number % numbers_.size()], number) == number;
  }

 private:
  std::array<uint32_t, 8> numbers_;
};

/// The triangles that `order` lists, in this order.
std::vector<PreparedTriangle> prepare_triangles(std::span<const Corners> triangles,
                                                std::span<const uint32_t> order);

}  // namespace kiwami::tools
