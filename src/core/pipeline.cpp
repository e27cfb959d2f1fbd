// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline.h"

#include <algorithm>

#include "builders/aac_builder.h"
#include "builders/agglomerative_builder.h"
#include "builders/binned_sah_builder.h"
#include "builders/lbvh_builder.h"
#include "builders/mini_tree_builder.h"
#include "builders/oibvh_builder.h"
#include "builders/ploc_builder.h"
#include "builders/spatial_split_builder.h"
#include "builders/str_builder.h"
#include "builders/sweep_sah_builder.h"
#include "bvh/representative_rays.h"
#include "bvh/tree_edit.h"
#include "core/error.h"
#include "optimizers/agglomerative_treelet.h"
#include "optimizers/nary_reorder.h"
#include "optimizers/reinsertion.h"
#include "optimizers/rotation.h"
#include "optimizers/sato_reorder.h"
#include "optimizers/sequential_reinsertion.h"
#include "optimizers/treelet_restructuring.h"
#include "wide/visit_weights.h"
#include "wide/wide_bottom_up.h"
#include "wide/wide_linear.h"
#include "wide/wide_top_down.h"

namespace kiwami {
namespace {

struct Method {
  uint32_t stage, number;
  const char* name;
};

constexpr Method kMethods[] = {
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_BINNED_SAH, "binned_sah"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_LBVH, "lbvh"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_PLOC, "ploc"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_SWEEP_SAH, "sweep_sah"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_SPATIAL_SPLIT, "spatial_split"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_AGGLOMERATIVE, "agglomerative"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_AAC, "aac"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_MINI_TREE, "mini_tree"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_OIBVH, "oibvh"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_WIDE_BOTTOM_UP, "wide_bottom_up"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_STR, "str"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_TRBVH, "trbvh"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_WIDE_TOP_DOWN, "wide_top_down"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_WIDE_LINEAR, "wide_linear"},
    {KIWAMI_STAGE_BUILDER, KIWAMI_BUILDER_TRIAL, "trial"},
    {KIWAMI_STAGE_CONTRACTION, KIWAMI_CONTRACTION_SURFACE_AREA, "surface_area"},
    {KIWAMI_STAGE_CONTRACTION, KIWAMI_CONTRACTION_OPTIMAL, "optimal"},
    {KIWAMI_STAGE_CONTRACTION, KIWAMI_CONTRACTION_RAY_DISTRIBUTION, "ray_distribution"},
};

/// Rays that are sampled where the user gives none.
constexpr size_t kSampledRayCount = 16384;

/// Of a node of two children, where a wide node costs 1: there are several in a wide one.
constexpr float kBinaryNodeCost = 0.5f;

SahCosts costs_of(const SceneParameters& parameters, uint32_t width) {
  return {static_cast<float>(parameters[KIWAMI_PARAMETER_NODE_COST]),
          static_cast<float>(parameters[KIWAMI_PARAMETER_LEAF_COST]), width};
}

SahConfig sah_config(const SceneParameters& parameters, uint32_t width) {
  const SahCosts costs = costs_of(parameters, width);
  SahConfig config;
  config.max_leaf_size = binary_leaf_size_of(parameters, width);
  config.block_size = width;
  config.node_cost = costs.node_cost;
  config.leaf_cost = costs.leaf_cost;
  return config;
}

BinnedSahBuilder::Config binned_sah_config(const SceneParameters& parameters, uint32_t width) {
  return {sah_config(parameters, width), parameters.whole(KIWAMI_PARAMETER_BIN_COUNT),
          parameters.whole(KIWAMI_PARAMETER_BIN_HALVING),
          parameters.whole(KIWAMI_PARAMETER_REASSIGN) != 0};
}

SpatialSplitBuilder::Config spatial_split_config(const SceneParameters& parameters,
                                                 uint32_t width) {
  return {sah_config(parameters, width), parameters.whole(KIWAMI_PARAMETER_BIN_COUNT),
          parameters[KIWAMI_PARAMETER_SPLIT_BUDGET], parameters[KIWAMI_PARAMETER_SPLIT_ALPHA]};
}

TreeletConfig treelet_config(uint32_t leaf_count, const SahCosts& costs) {
  TreeletConfig config;
  config.leaf_count = leaf_count;
  config.costs = costs;
  config.costs.node_cost *= kBinaryNodeCost;
  config.max_leaf_size = costs.block_size;
  return config;
}

uint32_t leaf_size_of(const SceneParameters& parameters, uint32_t width) {
  const uint32_t leaf_size = parameters.whole(KIWAMI_PARAMETER_MAX_LEAF_SIZE);
  return leaf_size != 0 ? std::min(leaf_size, width) : width;
}

/// Of the leaves where splitting ends if small subtrees are collapsed to leaves later, by what they
/// cost. Half the size, or four triangles, leaves that nearly all of the choice (within 2.3 % of
/// the cost from single triangles on real scenes) and makes a tree that is a third as large.
uint32_t collapsible_leaf_size(uint32_t leaf_size) {
  return std::min(leaf_size, std::max(4u, leaf_size / 2));
}

/// Whether an optimiser that the parameters name acts on the binary tree.
bool is_binary_edited(const SceneParameters& parameters);

/// Whether the builder makes leaves of several primitives where that is cheaper. Along a curve it
/// does so where nothing is changed after.
bool makes_leaves(const SceneParameters& parameters) {
  switch (parameters.whole(KIWAMI_PARAMETER_BUILDER)) {
    case KIWAMI_BUILDER_BINNED_SAH:
    case KIWAMI_BUILDER_SWEEP_SAH:
    case KIWAMI_BUILDER_SPATIAL_SPLIT:
      return true;
    case KIWAMI_BUILDER_LBVH:
      return !is_binary_edited(parameters);
    default:
      return false;
  }
}

CurveCode curve_code(const SceneParameters& parameters) {
  return parameters.whole(KIWAMI_PARAMETER_CURVE_CODE) != 0 ? CurveCode::kExtended
                                                            : CurveCode::kPlain;
}

LbvhBuilder::Config lbvh_config(const SceneParameters& parameters, uint32_t width) {
  const bool by_area = parameters.whole(KIWAMI_PARAMETER_LBVH_DELTA) != 0;
  return {by_area ? LbvhBuilder::Delta::kSurfaceArea : LbvhBuilder::Delta::kCode,
          curve_code(parameters),
          std::min(parameters.whole(KIWAMI_PARAMETER_LBVH_CHUNK_SIZE),
                   binary_leaf_size_of(parameters, width)),
          makes_leaves(parameters) ? binary_leaf_size_of(parameters, width) : 1,
          costs_of(parameters, width)};
}

PlocBuilder::Config ploc_config(const SceneParameters& parameters) {
  PlocBuilder::Config config;
  config.curve_code = curve_code(parameters);
  return config;
}

AacBuilder::Config aac_config(const SceneParameters& parameters) {
  AacBuilder::Config config = parameters.whole(KIWAMI_PARAMETER_AAC_QUALITY) != 0
                                  ? AacBuilder::high_quality()
                                  : AacBuilder::fast();
  config.curve_code = curve_code(parameters);
  return config;
}

/// One call of the chosen builder.
BinaryBvh run_builder(Array<BuildPrimitive> primitives, const TriangleSource& source,
                      const SceneParameters& parameters, uint32_t width, Memory& memory,
                      const Parallel& parallel) {
  switch (parameters.whole(KIWAMI_PARAMETER_BUILDER)) {
    case KIWAMI_BUILDER_LBVH:
      return LbvhBuilder::build(std::move(primitives), lbvh_config(parameters, width), memory,
                                parallel);
    case KIWAMI_BUILDER_PLOC:
      return PlocBuilder::build(std::move(primitives), ploc_config(parameters), memory, parallel);
    case KIWAMI_BUILDER_TRBVH: {
      BinaryBvh bvh = LbvhBuilder::build(std::move(primitives), {}, memory, parallel);
      optimize_by_treelets(bvh, treelet_config(7, costs_of(parameters, width)), memory, parallel);
      return bvh;
    }
    case KIWAMI_BUILDER_SWEEP_SAH:
      return SweepSahBuilder::build(std::move(primitives), sah_config(parameters, width), memory,
                                    parallel);
    case KIWAMI_BUILDER_SPATIAL_SPLIT:
      if (source.mesh_count == 0 && !primitives.empty()) {
        throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                    "the builder spatial_split cuts triangles, expected a mesh in place of boxes");
      }
      return SpatialSplitBuilder::build(std::move(primitives), source,
                                        spatial_split_config(parameters, width), memory, parallel);
    case KIWAMI_BUILDER_AGGLOMERATIVE:
      return AgglomerativeBuilder::build(std::move(primitives), {}, memory, parallel);
    case KIWAMI_BUILDER_AAC:
      return AacBuilder::build(std::move(primitives), aac_config(parameters), memory, parallel);
    case KIWAMI_BUILDER_MINI_TREE:
      return MiniTreeBuilder::build(std::move(primitives), {}, memory, parallel);
    case KIWAMI_BUILDER_OIBVH:
      return OibvhBuilder::build(std::move(primitives), memory, parallel);
    case KIWAMI_BUILDER_STR:
      return StrBuilder::build(std::move(primitives), {width}, memory, parallel);
    default:
      return BinnedSahBuilder::build(std::move(primitives), binned_sah_config(parameters, width),
                                     memory, parallel);
  }
}

/// What an optimiser may know beside its tree.
struct OptimizerInput {
  const TriangleSource& source;
  std::span<const RepresentativeRay> rays;
  SahCosts costs;
  Memory& memory;
  const Parallel& parallel;
};

/// An optimiser acts on one of the two trees: the function of the other one is null.
struct Optimizer {
  uint32_t number;
  const char* name;
  void (*on_binary)(BinaryBvh& bvh, const OptimizerInput& input);
  void (*on_wide)(WideTree& tree, const OptimizerInput& input);
};

constexpr Optimizer kOptimizers[] = {
    {KIWAMI_OPTIMIZER_PARALLEL_REINSERTION, "parallel_reinsertion",
     [](BinaryBvh& bvh, const OptimizerInput& input) {
       ReinsertionConfig config;
       config.costs = input.costs;
       optimize_by_parallel_reinsertion(bvh, config, input.memory, input.parallel);
     },
     nullptr},
    {KIWAMI_OPTIMIZER_ROTATION, "rotation",
     [](BinaryBvh& bvh, const OptimizerInput& input) {
       RotationConfig config;
       config.costs = input.costs;
       optimize_by_rotation(bvh, config, input.memory);
     },
     nullptr},
    {KIWAMI_OPTIMIZER_TREELET, "treelet",
     [](BinaryBvh& bvh, const OptimizerInput& input) {
       optimize_by_treelets(bvh, treelet_config(7, input.costs), input.memory, input.parallel);
     },
     nullptr},
    {KIWAMI_OPTIMIZER_AGGLOMERATIVE_TREELET, "agglomerative_treelet",
     [](BinaryBvh& bvh, const OptimizerInput& input) {
       optimize_by_agglomerative_treelets(bvh, treelet_config(9, input.costs), input.memory,
                                          input.parallel);
     },
     nullptr},
    {KIWAMI_OPTIMIZER_REINSERTION, "reinsertion",
     [](BinaryBvh& bvh, const OptimizerInput& input) {
       SequentialReinsertionConfig config;
       config.costs = input.costs;
       optimize_by_reinsertion(bvh, config, input.memory);
     },
     nullptr},
    {KIWAMI_OPTIMIZER_REORDER_SATO, "reorder_sato", nullptr,
     [](WideTree& tree, const OptimizerInput& input) {
       reorder_by_surface_area(tree, input.memory, input.parallel);
     }},
    {KIWAMI_OPTIMIZER_REORDER_NARY, "reorder_nary", nullptr,
     [](WideTree& tree, const OptimizerInput& input) {
       const NaryReorderConfig config = {input.costs.node_cost, input.costs.leaf_cost};
       reorder_by_rays(tree, input.source, input.rays, config, input.memory, input.parallel);
     }},
};

const Optimizer* find_optimizer(uint32_t number) {
  for (const Optimizer& optimizer : kOptimizers) {
    if (optimizer.number == number) return &optimizer;
  }
  return nullptr;
}

bool is_binary_edited(const SceneParameters& parameters) {
  const std::span<const uint32_t> methods = parameters.optimizers();
  return std::any_of(methods.begin(), methods.end(),
                     [](uint32_t method) { return find_optimizer(method)->on_binary != nullptr; });
}

ContractionMethod contraction_of(const SceneParameters& parameters) {
  return static_cast<ContractionMethod>(parameters.whole(KIWAMI_PARAMETER_CONTRACTION));
}

WideBottomUpConfig bottom_up_config(const WideTreeConfig& config,
                                    const SceneParameters& parameters) {
  WideBottomUpConfig bottom_up;
  bottom_up.width = config.width;
  bottom_up.leaf_width = config.max_leaf_size;
  bottom_up.node_cost = config.node_cost;
  bottom_up.leaf_cost = config.leaf_cost;
  bottom_up.fill_nodes = config.merge_leaves;
  bottom_up.curve_code = curve_code(parameters);
  return bottom_up;
}

WideTopDownConfig top_down_config(const WideTreeConfig& config, const SceneParameters& parameters) {
  WideTopDownConfig top_down;
  top_down.width = config.width;
  top_down.leaf_width = config.max_leaf_size;
  top_down.fill_nodes = config.merge_leaves;
  top_down.splits = binned_sah_config(parameters, config.width);
  top_down.splits.max_leaf_size = collapsible_leaf_size(config.max_leaf_size);
  return top_down;
}

}  // namespace

const char* method_name(uint32_t stage, uint32_t number) {
  if (stage == KIWAMI_STAGE_OPTIMIZER) {
    const Optimizer* optimizer = find_optimizer(number);
    return optimizer ? optimizer->name : nullptr;
  }
  for (const Method& method : kMethods) {
    if (method.stage == stage && method.number == number) return method.name;
  }
  return nullptr;
}

uint32_t highest_method(uint32_t stage) {
  uint32_t highest = 0;
  if (stage == KIWAMI_STAGE_OPTIMIZER) {
    for (const Optimizer& optimizer : kOptimizers) highest = std::max(highest, optimizer.number);
  }
  for (const Method& method : kMethods) {
    if (method.stage == stage) highest = std::max(highest, method.number);
  }
  return highest;
}

uint32_t binary_leaf_size_of(const SceneParameters& parameters, uint32_t width) {
  const uint32_t leaf_size = leaf_size_of(parameters, width);
  // The other contractions collapse small subtrees to leaves themselves.
  const bool is_collapsed =
      parameters.whole(KIWAMI_PARAMETER_CONTRACTION) != KIWAMI_CONTRACTION_SURFACE_AREA;
  return is_collapsed ? collapsible_leaf_size(leaf_size) : leaf_size;
}

WideTreeConfig wide_tree_config(const SceneParameters& parameters, uint32_t width) {
  WideTreeConfig config;
  config.width = width;
  config.leaf_layout = parameters.whole(KIWAMI_PARAMETER_LAYOUT) == KIWAMI_LAYOUT_COMPACT
                           ? LeafLayout::kIndices
                           : LeafLayout::kTriangles;
  config.contraction = contraction_of(parameters);
  config.max_leaf_size = leaf_size_of(parameters, width);
  config.merge_leaves = parameters.whole(KIWAMI_PARAMETER_MERGE_LEAVES) != 0;
  config.merge_ring = parameters.whole(KIWAMI_PARAMETER_MERGE_RING);
  config.node_cost = static_cast<float>(parameters[KIWAMI_PARAMETER_NODE_COST]);
  config.leaf_cost = static_cast<float>(parameters[KIWAMI_PARAMETER_LEAF_COST]);
  return config;
}

namespace {

/// By one builder.
BinaryBvh build_by(Array<BuildPrimitive> primitives, const TriangleSource& source,
                   const SceneParameters& parameters, uint32_t width, Memory& memory,
                   const Parallel& parallel) {
  const SahCosts costs = costs_of(parameters, width);
  BinaryBvh bvh = run_builder(std::move(primitives), source, parameters, width, memory, parallel);
  for (const uint32_t method : parameters.optimizers()) {
    const Optimizer& optimizer = *find_optimizer(method);
    parallel.check_cancelled();
    if (optimizer.on_binary) optimizer.on_binary(bvh, {source, {}, costs, memory, parallel});
  }
  // Builders that know nothing of blocks leave one primitive a leaf.
  if (!makes_leaves(parameters)) {
    collapse_leaves(bvh, binary_leaf_size_of(parameters, width), costs, memory);
  }
  return bvh;
}

/// What a ray costs in the wide tree that a binary one becomes, by the visits of representative
/// rays.
double cost_to_rays(const BinaryBvh& bvh, const TriangleSource& source,
                    const WideTreeConfig& config, Memory& memory, const Parallel& parallel) {
  const Array<float> weights =
      measure_visit_weights(bvh, source, config.rays, kVisitGuessWeight, memory, parallel);
  const Contraction contraction = contract_by(bvh, source, config, memory, parallel);
  double cost = 0.0;
  for (const ContractedSlot& slot : contraction.slots) {
    const float of_slot = slot.is_leaf() ? config.leaf_cost : config.node_cost;
    cost += static_cast<double>(of_slot) * static_cast<double>(weights[slot.binary_node]);
  }
  return cost;
}

/// What makes the splits of a builder of wide trees into a binary one.
SceneParameters binary_twin_of(SceneParameters parameters) {
  switch (parameters.whole(KIWAMI_PARAMETER_BUILDER)) {
    case KIWAMI_BUILDER_WIDE_LINEAR:
      parameters.set(KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_LBVH);
      parameters.set(KIWAMI_PARAMETER_CURVE_CODE, 1);
      break;
    case KIWAMI_BUILDER_WIDE_TOP_DOWN:
    case KIWAMI_BUILDER_WIDE_BOTTOM_UP:
      parameters.set(KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_BINNED_SAH);
      break;
  }
  return parameters;
}

/// Top-down or bottom-up: which of the two is the better tree depends on the scene, and that of the
/// lower cost by areas is often not the one that rays visit less. So both are built, and tried.
BinaryBvh build_by_trial(Array<BuildPrimitive> primitives, const TriangleSource& source,
                         std::span<const RepresentativeRay> rays, SceneParameters parameters,
                         uint32_t width, Memory& memory, const Parallel& parallel) {
  Array<BuildPrimitive> copy(memory, primitives.size());
  std::copy(primitives.begin(), primitives.end(), copy.begin());
  parameters.set(KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_PLOC);
  BinaryBvh bottom_up = build_by(std::move(copy), source, parameters, width, memory, parallel);
  parameters.set(KIWAMI_PARAMETER_BUILDER, KIWAMI_BUILDER_BINNED_SAH);
  BinaryBvh top_down = build_by(std::move(primitives), source, parameters, width, memory, parallel);
  if (top_down.nodes.empty()) return top_down;
  WideTreeConfig config = wide_tree_config(parameters, width);
  config.rays = rays;
  const double of_top_down = cost_to_rays(top_down, source, config, memory, parallel);
  const double of_bottom_up = cost_to_rays(bottom_up, source, config, memory, parallel);
  return of_bottom_up < of_top_down ? std::move(bottom_up) : std::move(top_down);
}

}  // namespace

BinaryBvh build_binary_bvh(Array<BuildPrimitive> primitives, const TriangleSource& source,
                           std::span<const RepresentativeRay> rays,
                           const SceneParameters& parameters, uint32_t width, Memory& memory,
                           const Parallel& parallel) {
  if (parameters.whole(KIWAMI_PARAMETER_BUILDER) == KIWAMI_BUILDER_TRIAL) {
    return build_by_trial(std::move(primitives), source, rays, parameters, width, memory, parallel);
  }
  return build_by(std::move(primitives), source, binary_twin_of(parameters), width, memory,
                  parallel);
}

Array<RepresentativeRay> sample_rays_for(const SceneParameters& parameters,
                                         const TriangleSource& source, Memory& memory) {
  const std::span<const uint32_t> methods = parameters.optimizers();
  const bool goes_by_rays =
      parameters.whole(KIWAMI_PARAMETER_BUILDER) == KIWAMI_BUILDER_TRIAL ||
      parameters.whole(KIWAMI_PARAMETER_CONTRACTION) == KIWAMI_CONTRACTION_RAY_DISTRIBUTION ||
      std::count(methods.begin(), methods.end(), KIWAMI_OPTIMIZER_REORDER_NARY) != 0;
  return goes_by_rays ? sample_rays(source, kSampledRayCount, memory) : Array<RepresentativeRay>();
}

void optimize_wide_tree(WideTree& tree, const TriangleSource& source,
                        std::span<const RepresentativeRay> rays, const SceneParameters& parameters,
                        Memory& memory, const Parallel& parallel) {
  const SahCosts costs = costs_of(parameters, tree.width);
  for (const uint32_t method : parameters.optimizers()) {
    const Optimizer& optimizer = *find_optimizer(method);
    parallel.check_cancelled();
    if (optimizer.on_wide) optimizer.on_wide(tree, {source, rays, costs, memory, parallel});
  }
}

bool builds_wide_tree(const SceneParameters& parameters) {
  switch (parameters.whole(KIWAMI_PARAMETER_BUILDER)) {
    case KIWAMI_BUILDER_WIDE_BOTTOM_UP:
      return true;
    case KIWAMI_BUILDER_WIDE_TOP_DOWN:
    case KIWAMI_BUILDER_WIDE_LINEAR:
      return !is_binary_edited(parameters) &&
             parameters.whole(KIWAMI_PARAMETER_CONTRACTION) == KIWAMI_CONTRACTION_OPTIMAL;
    default:
      return false;
  }
}

WideDraft build_wide_draft(Array<BuildPrimitive> primitives, const WideTreeConfig& config,
                           const SceneParameters& parameters, Memory& memory,
                           const Parallel& parallel) {
  const uint32_t builder = parameters.whole(KIWAMI_PARAMETER_BUILDER);
  for (const uint32_t method : parameters.optimizers()) {
    if (!find_optimizer(method)->on_binary) continue;
    throw Error(KIWAMI_ERROR_INVALID_ARGUMENT,
                "builder %s makes no binary tree that %s could change, expected no optimizers but "
                "those of wide trees",
                method_name(KIWAMI_STAGE_BUILDER, builder),
                method_name(KIWAMI_STAGE_OPTIMIZER, method));
  }
  if (builder == KIWAMI_BUILDER_WIDE_LINEAR) {
    return build_wide_linear(std::move(primitives), {config.width, config.max_leaf_size}, memory,
                             parallel);
  }
  if (builder == KIWAMI_BUILDER_WIDE_TOP_DOWN) {
    return build_wide_top_down(std::move(primitives), top_down_config(config, parameters), memory,
                               parallel);
  }
  return build_wide_bottom_up(std::move(primitives), bottom_up_config(config, parameters), memory,
                              parallel);
}

}  // namespace kiwami
