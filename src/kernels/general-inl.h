// SPDX-License-Identifier: Apache-2.0
// The kernels for scenes of all kinds and for all that a query may ask: one ray after the other,
// through the tree of a scene's triangles, its further parts, and the scenes that it instances.
// They are objects of their own, so that the plain kernels know nothing of all this.
#pragma once

#define KIWAMI_INLINE_CHOICE __attribute__((always_inline)) inline

#include "kernels/answers-inl.h"
#include "kernels/general-list-inl.h"
#include "kernels/motion-inl.h"
#include "kernels/shape-leaf-inl.h"
#include "kernels/user-leaf-inl.h"
#include "wide/instance_part.h"
#include "wide/mesh_part.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The ray as the tree of a part reads it.
inline void set_up_for_part(const UnalignedRay& ray, const ScenePart& part, ReadyRay& out) {
  set_up(ray, part.tree, out);
  const float farthest = first_lane(greatest_of_three(absolute(origin_of(ray))));
  if (__builtin_expect(!(farthest > part.far_origin), 1)) return;
  // The slabs of the greatest bounds take two more roundings here.
  constexpr float rounding = 4.0f * 0x1p-24f;
  const float margin = (farthest - part.far_origin) * part.far_origin_margin + farthest * rounding;
  for (int axis = 0; axis < 3; ++axis) {
    const float wider = margin * __builtin_fabsf(out.reciprocal[axis]);
    out.near_offset[axis] -= wider;
    out.far_offset[axis] += wider;
  }
}

/// Puts the transform of a moving instance at a time into a record; false where there is none.
// Not inlined: it stands in each query.
__attribute__((noinline)) bool freeze(const MovingInstancePart& part, uint32_t number, float time,
                                      InstanceRecord& record) {
  const MovingArray& array = array_of(part.arrays, part.array_count, number);
  float rows[12];
  if (!matrix_at(array, number, time, rows)) return false;
  if (!array.is_regular) return invert_for_rays(rows, record.column);
  invert_regular(rows, record.column);
  return true;
}

/// The ray in the space of an instanced scene. Not normalised: a distance stays the same number.
/// Both halves are written as they will be read: a load that spans several stores waits for them.
inline kiwami_ray transform(const InstanceRecord& instance, const UnalignedRay& ray) {
  const auto column = [&](int k) { return load_from_bytes<4>(instance.column[k]); };
  const vfloat<4> x = column(0), y = column(1), z = column(2);
  const vfloat<4> origin = ((x * broadcast<4>(ray.origin_x) + y * broadcast<4>(ray.origin_y)) +
                            z * broadcast<4>(ray.origin_z)) +
                           column(3);
  const vfloat<4> direction =
      (x * broadcast<4>(ray.direction_x) + y * broadcast<4>(ray.direction_y)) +
      z * broadcast<4>(ray.direction_z);
  constexpr float last[4] = {1.0f, 1.0f, 1.0f, -1.0f};
  const vfloat<4> is_last = load<4>(last);
  kiwami_ray local;
  auto* const halves = reinterpret_cast<float*>(&local);
  store(halves, select_negative(is_last, broadcast<4>(ray.tmin), origin));
  store(halves + 4, select_negative(is_last, broadcast<4>(ray.tmax), direction));
  local.time = ray.time;
  local.mask = ray.mask;
  local.flags = ray.flags;
  local.id = ray.id;
  return local;
}
static_assert(offsetof(kiwami_ray, tmin) == 3 * sizeof(float) &&
              offsetof(kiwami_ray, direction_x) == 4 * sizeof(float) &&
              offsetof(kiwami_ray, tmax) == 7 * sizeof(float));

/// One ray on its way through a graph of scenes. Scenes are visited by recursion: a path has at
/// most KIWAMI_MAX_INSTANCE_DEPTH instances.
template <typename Query, int N, typename Probe>
struct GeneralTraversal {
  Query& query;
  Probe& probe;

  /// Visits what the query has to see of a scene, by the ray as it is there, which is_traceable.
  /// Returns true if the query ended.
  bool visit_scene(const SceneView& scene, const UnalignedRay& ray) {
    if (scene.tree.root.mask() == 0 && scene.part_count == 1) {
      ReadyRay ready;
      return visit_part(scene, scene.parts[0], scene.parts[0].tree.root, ray, ready);
    }
    return visit_from(scene, ray, {0, InstanceStart::kAllTrees, {}});
  }

  /// The same of a part of the scene.
  // Not inlined: it calls itself.
  __attribute__((noinline)) bool visit_from(const SceneView& scene, const UnalignedRay& ray,
                                            const InstanceStart& start) {
    ReadyRay ready;
    if (start.tree != InstanceStart::kAllTrees) {
      return start.tree == 0
                 ? visit_triangles(scene, start.subtree, ray, ready)
                 : visit_part(scene, scene.parts[start.tree - 1], start.subtree, ray, ready);
    }
    if (scene.tree.root.mask() != 0 && visit_triangles(scene, scene.tree.root, ray, ready)) {
      return true;
    }
    for (uint32_t i = 0; i < scene.part_count; ++i) {
      const ScenePart& part = scene.parts[i];
      if (visit_part(scene, part, part.tree.root, ray, ready)) return true;
    }
    return false;
  }

  bool visit_triangles(const SceneView& scene, ChildReference subtree, const UnalignedRay& ray,
                       ReadyRay& ready) {
    set_up(ray, scene.tree, ready);
    query.set_level(scene, ready, query.reach());
    return traverse<N>(scene.tree, {subtree, ready.nearest}, ready, query, probe);
  }

  bool visit_part(const SceneView& scene, const ScenePart& part, ChildReference subtree,
                  const UnalignedRay& ray, ReadyRay& ready) {
    set_up_for_part(ray, part, ready);
    query.set_level(scene, ready, query.reach());
    switch (part.kind) {
      case PartKind::kInstances: {
        InstanceVisitor visitor{*this, scene, *static_cast<const InstancePart*>(part.data),
                                ray,   ready, query.best_bound};
        return traverse<N>(part.tree, {subtree, ready.nearest}, ready, visitor, probe);
      }
      case PartKind::kShapes: {
        const auto& source = *static_cast<const ShapeSource*>(part.data);
        ShapeVisitor visitor{query, source, ready, shape_ray(ray, source.kind), query.best_bound};
        return traverse<N>(part.tree, {subtree, ready.nearest}, ready, visitor, probe);
      }
      case PartKind::kMovingTriangles: {
        const auto& motion = *static_cast<const MotionPart*>(part.data);
        MovingBoxReader<N> boxes;
        if (!boxes.begin(motion.boxes, ray.time)) return false;
        query.set_level(motion.scene, ready, query.reach());
        MotionVisitor visitor{query, LeafFreezer<N>(motion, ray.time), boxes, query.best_bound};
        return traverse<N>(part.tree, {subtree, ready.nearest}, ready, visitor, probe);
      }
      case PartKind::kUser: {
        kiwami_ray aligned;
        __builtin_memcpy(&aligned, &ray, sizeof aligned);
        UserVisitor visitor{query, *static_cast<const UserSource*>(part.data), ready, aligned,
                            query.best_bound};
        return traverse<N>(part.tree, {subtree, ready.nearest}, ready, visitor, probe);
      }
      case PartKind::kMeshes: {
        MeshVisitor visitor{*this, scene, *static_cast<const MeshPart*>(part.data),
                            ray,   ready, query.best_bound};
        return traverse<N>(part.tree, {subtree, ready.nearest}, ready, visitor, probe);
      }
      case PartKind::kMovingInstances: {
        const auto& moving = *static_cast<const MovingInstancePart*>(part.data);
        MovingBoxReader<N> boxes;
        if (!boxes.begin(moving.boxes, ray.time)) return false;
        MovingInstanceVisitor visitor(
            InstanceVisitor{*this, scene, moving.instances, ray, ready, query.best_bound}, moving,
            boxes);
        return traverse<N>(part.tree, {subtree, ready.nearest}, ready, visitor, probe);
      }
    }
    return false;
  }

  /// Enters the trees of meshes, by the same ray.
  struct MeshVisitor {
    static constexpr bool kOrdered = Query::kOrdered;

    GeneralTraversal& traversal;
    const SceneView& scene;
    const MeshPart& part;
    const UnalignedRay& ray;
    const ReadyRay& ready;
    float best_bound;

    bool visit_block(const TreeView& tree, ChildReference reference, Probe&) {
      const IndexBlock<N>& block = index_leaf_at<N>(tree.memory, reference);
      for (uint32_t lanes = reference.mask(); lanes; lanes &= lanes - 1) {
        const SceneView& mesh = *part.scenes[block.id[__builtin_ctz(lanes)]];
        const auto level = traversal.probe.enter(ready);
        if (traversal.visit_scene(mesh, ray)) return true;
        traversal.probe.leave(level);
        traversal.query.set_level(scene, ready, traversal.query.reach());
        best_bound = traversal.query.best_bound;
      }
      return false;
    }
  };

  /// Enters the instances in the leaves of a part.
  struct InstanceVisitor {
    static constexpr bool kOrdered = Query::kOrdered;

    GeneralTraversal& traversal;
    const SceneView& scene;
    const InstancePart& part;
    const UnalignedRay& ray;
    const ReadyRay& ready;
    float best_bound;

    bool visit_block(const TreeView& tree, ChildReference reference, Probe&) {
      const IndexBlock<N>& block = index_leaf_at<N>(tree.memory, reference);
      for (uint32_t lanes = reference.mask(); lanes; lanes &= lanes - 1) {
        const uint32_t id = block.id[__builtin_ctz(lanes)];
        const InstanceStart start =
            part.starts ? part.starts[id] : InstanceStart{id, InstanceStart::kAllTrees, {}};
        const InstanceRecord& instance = part.instances[start.instance];
        if (is_seen(start.instance, instance) && visit_instance(start, instance)) return true;
      }
      return false;
    }

    bool is_seen(uint32_t number, const InstanceRecord& instance) const {
      const uint32_t mask = part.prototypes[instance.prototype].mask;
      return (ray.mask & (part.masks ? part.masks[number] & mask : mask)) != 0;
    }

    /// A mesh alone, which most scenes show, is visited without a call that may call itself.
    bool visit_scene(const SceneView& shown, const kiwami_ray& local, const InstanceStart& start) {
      if (shown.part_count != 0) return traversal.visit_from(shown, local, start);
      const ChildReference subtree = start.tree == 0 ? start.subtree : shown.tree.root;
      if (subtree.mask() == 0) return false;
      ReadyRay local_ready;
      return traversal.visit_triangles(shown, subtree, local, local_ready);
    }

    bool visit_instance(const InstanceStart& start, const InstanceRecord& instance) {
      const uint32_t number = start.instance;
      const Prototype& prototype = part.prototypes[instance.prototype];
      const kiwami_ray local = transform(instance, ray);
      if (!is_traceable(local)) return false;
      Query& asked = traversal.query;
      asked.path.number[asked.path.depth++] = number;
      const auto level = traversal.probe.enter(ready);
      const bool is_done = visit_scene(*prototype.scene, local, start);
      traversal.probe.leave(level);
      --asked.path.depth;
      if (is_done) return true;
      asked.set_level(scene, ready, asked.reach());
      best_bound = asked.best_bound;
      return false;
    }
  };

  /// The same of instances that move, at the time of the ray.
  struct MovingInstanceVisitor : InstanceVisitor {
    const MovingInstancePart& moving;
    MovingBoxReader<N> boxes;

    MovingInstanceVisitor(const InstanceVisitor& visitor, const MovingInstancePart& moving_part,
                          const MovingBoxReader<N>& boxes_then)
        : InstanceVisitor(visitor), moving(moving_part), boxes(boxes_then) {}

    uint32_t test_boxes(ChildReference node, const SlabRay<N>& slabs, vfloat<N>& entry) const {
      return boxes.test(node, slabs, this->best_bound, entry);
    }

    bool visit_block(const TreeView& tree, ChildReference reference, Probe&) {
      const IndexBlock<N>& block = index_leaf_at<N>(tree.memory, reference);
      for (uint32_t lanes = reference.mask(); lanes; lanes &= lanes - 1) {
        const uint32_t number = block.id[__builtin_ctz(lanes)];
        InstanceRecord frozen;
        frozen.prototype = moving.instances.instances[number].prototype;
        if (this->is_seen(number, frozen) && freeze(moving, number, this->ray.time, frozen) &&
            this->visit_instance({number, InstanceStart::kAllTrees, {}}, frozen)) {
          return true;
        }
      }
      return false;
    }
  };

  /// Tests the spheres, discs or curve segments in the leaves of a part.
  struct ShapeVisitor {
    static constexpr bool kOrdered = Query::kOrdered;

    Query& query;
    const ShapeSource& source;
    const ReadyRay& ready;
    ShapeRay ray;
    float best_bound;

    bool visit_block(const TreeView& tree, ChildReference reference, Probe& counting) {
      const bool is_done =
          visit_shapes<N>(source, tree, reference, ready, ray, [&](const ShapeCrossing& crossing) {
            counting.on_accept_in_leaf(ready, crossing.t);
            return query.accept(
                crossing.t, crossing.shape.view->geometry_id, crossing.shape.primitive,
                [&](kiwami_hit& hit) { describe_crossing(source, ray.wide, crossing, hit); });
          });
      best_bound = query.best_bound;
      return is_done;
    }
  };

  /// Tests the moving triangles in the leaves of a part, at the time of the ray.
  struct MotionVisitor {
    static constexpr bool kOrdered = Query::kOrdered;

    Query& query;
    LeafFreezer<N> freezer;
    MovingBoxReader<N> boxes;
    float best_bound;

    uint32_t test_boxes(ChildReference node, const SlabRay<N>& slabs, vfloat<N>& entry) const {
      return boxes.test(node, slabs, best_bound, entry);
    }

    bool visit_block(const TreeView& tree, ChildReference reference, Probe& counting) {
      const IndexBlock<N>& block = index_leaf_at<N>(tree.memory, reference);
      GatheredBlock<N> frozen;
      frozen.source = block.id;
      const uint32_t lanes = freezer.freeze(tree, block, reference.mask(), frozen);
      const bool is_done = query.visit_leaf(frozen, lanes, counting);
      best_bound = query.best_bound;
      return is_done;
    }
  };

  /// Asks the caller for the user primitives in the leaves of a part.
  struct UserVisitor {
    static constexpr bool kOrdered = Query::kOrdered;

    Query& query;
    const UserSource& source;
    const ReadyRay& ready;
    kiwami_ray ray;
    float best_bound;

    bool visit_block(const TreeView& tree, ChildReference reference, Probe&) {
      ray.tmax = query.reach();
      bool has_failed = false;
      const bool is_done = visit_user_primitives<N>(
          source, index_leaf_at<N>(tree.memory, reference), reference.mask(), ray, has_failed,
          [&](const UserView& view, const kiwami_user_hit& found) {
            return query.accept(found.t, view.geometry_id, found.primitive_id,
                                [&](kiwami_hit& hit) { describe_user_hit(found, hit); });
          });
      if (has_failed) query.options->report_failed_callback();
      best_bound = query.best_bound;
      return is_done;
    }
  };
};

template <typename Query, int N, typename Probe>
inline void trace_general(const SceneView& scene, const RayBatch& batch,
                          const QueryOptions& options, Probe& probe) {
  for (size_t i = 0; i < batch.count; ++i) {
    if (options.has_failed_callback()) return;
    const UnalignedRay& ray = ray_of(batch, i);
    Query query;
    query.begin(options, i, ray);
    if (is_traceable(ray)) GeneralTraversal<Query, N, Probe>{query, probe}.visit_scene(scene, ray);
    write_answer(batch, i, query.answer());
    query.deliver();
  }
}

template <typename Query, int N>
void general_kernel(const SceneView& scene, const RayBatch& batch, const QueryOptions& options) {
  NoProbe probe;
  trace_general<Query, N>(scene, batch, options, probe);
}

template <typename Query, int N>
void counting_general_kernel(const SceneView& scene, const RayBatch& batch,
                             const QueryOptions& options, TraversalCounters& counters) {
  CountingProbe<N> probe{counters};
  trace_general<Query, N>(scene, batch, options, probe);
}

/// See GeneralListKernel.
template <int N>
uint32_t general_nearest_hits(const SceneView& scene, const RayBatch& batch,
                              const QueryOptions& options, const GeneralHitList& list) {
  using Query = GeneralNearestHits<N>;
  const UnalignedRay& ray = ray_of(batch, 0);
  if (!is_traceable(ray)) return 0;
  NoProbe probe;
  Query query;
  query.begin(options, ray, list);
  // Nothing before the last hit is of interest, which may be one of several at its distance.
  kiwami_ray rest;
  __builtin_memcpy(&rest, &ray, sizeof rest);
  if (list.after && list.after->hit.t > rest.tmin) rest.tmin = list.after->hit.t;
  GeneralTraversal<Query, N, NoProbe>{query, probe}.visit_scene(scene, rest);
  return query.list.count;
}

template <int N>
inline GeneralKernels general_of_width() {
  return {general_kernel<GeneralClosestHit<N>, N>,
          general_kernel<GeneralAnyHit<N>, N>,
          general_kernel<GeneralAllHits<N>, N>,
          counting_general_kernel<GeneralClosestHit<N>, N>,
          counting_general_kernel<GeneralAnyHit<N>, N>,
          general_nearest_hits<N>};
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
