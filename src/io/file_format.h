// SPDX-License-Identifier: Apache-2.0
// What a file is made of: a header, a directory, and sections at multiples of 64 bytes (the tree's
// nodes at one of 4096, so that a mapped file has them on pages of their own). docs/files.md tells
// it to other programs. Layouts are frozen; a section that changes gets a new version.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>

namespace kiwami::file {

static_assert(std::endian::native == std::endian::little, "files hold the machine's own numbers");

/// Like PNG's: what is no text is told from it, and a transfer as text shows.
constexpr unsigned char kMagic[8] = {0x89, 'K', 'I', 'W', 'A', 'M', 'I', '\n'};
constexpr uint32_t kByteOrder = 0x01020304;

constexpr size_t kSectionAlignment = 64;
constexpr size_t kPageAlignment = 4096;

struct Header {
  unsigned char magic[8];
  uint32_t byte_order;
  uint32_t format_version;
  uint32_t library_version;
  uint32_t kind;
  uint32_t section_count;
  uint32_t reserved;
  uint64_t file_bytes;
  uint64_t directory_checksum;
  uint64_t reserved_bytes;
  uint64_t header_checksum;  ///< of the bytes before it
};
static_assert(sizeof(Header) == 64 && offsetof(Header, header_checksum) == 56);

/// The numbers of sections are pinned. Sections that would be empty may be absent.
enum class SectionType : uint32_t {
  kScene = 1,             ///< SceneRecord
  kTrees = 2,             ///< of each tree: nodes, then leaf blocks, as in memory
  kGeometries = 3,        ///< GeometryRecord by geometry id
  kBuffers = 4,           ///< of all geometries, one after the other
  kTreeRecords = 5,       ///< TreeRecord by the order of the trees
  kParameters = 6,        ///< ParameterRecord
  kBvh = 7,               ///< BvhRecord
  kNodes = 8,             ///< kiwami_bvh_node
  kPrimitives = 9,        ///< uint32, the primitives in the order of the tree
  kSkipped = 10,          ///< uint32, what the build left out, rising
  kBoxes = 11,            ///< six floats a box
  kShownScenes = 12,      ///< uint32, the scenes that instances show, by geometry
  kInstances = 13,        ///< InstancesRecord
  kInstanceRecords = 14,  ///< InstanceRecord
  kInstanceMasks = 15,    ///< uint32 by instance
  kInstanceStarts = 16,   ///< InstanceStart
  kMotionBounds = 17,     ///< MotionBounds by segment and node
  kLightSet = 18,         ///< LightSetRecord
  kLights = 19,           ///< LightRecord
  kLightUserIds = 20,     ///< uint32 by light
  kLightInstances = 21,   ///< SavedLightInstance
  kLightLinks = 22,       ///< uint32 by cluster: LightLinks
  kLightSlots = 23,       ///< uint32 by slot: WideLightTree::slot_clusters
  kMovingInstances = 24,  ///< MovingInstancesRecord
  kInstanceSteps = 25,    ///< float, the steps of instances that move, as kernels take them
  kInstanceBoxes = 26,    ///< MotionBounds by segment and node of their tree
  kMovingArrays = 27      ///< uint32 by array that moves: MovingArray::is_regular
};
/// Of all of them.
constexpr uint32_t kSectionVersion = 1;

enum : uint32_t {
  /// Who does not know the section must not use the file. Others can be passed over.
  kSectionRequired = 1u << 0
};

/// One line of the directory, which follows the header. Sections stand in the order of their lines
/// and do not overlap. Those of a scene follow each other.
struct SectionEntry {
  uint32_t type;
  uint32_t version;
  uint32_t flags;
  uint32_t
      scene;  ///< 0: the one that is saved; those that it shows follow. A scene shows only such
              ///< of higher numbers.
  uint64_t offset;
  uint64_t bytes;
  uint64_t checksum;
  uint64_t reserved_bytes;
};
static_assert(sizeof(SectionEntry) == 48);

/// What is told of a scene without looking at the rest.
struct SceneRecord {
  uint32_t bvh_width;
  uint32_t reserved;
  uint64_t triangle_count;  ///< as kiwami_scene_info
  uint64_t node_count;
  double build_seconds;
};
static_assert(sizeof(SceneRecord) == 32);

/// What the leaves of a tree hold. The trees of a scene stand in this order, which is also that of
/// the parts that kernels see.
enum class TreeRole : uint32_t {
  kTriangles = 0,        ///< the static triangles; always there
  kTrianglesOfMesh = 1,  ///< those of one mesh (KIWAMI_PARAMETER_TWO_LEVEL), by geometry id
  kInstances = 2,        ///< those that rest
  kMovingInstances = 3,
  kSpheres = 4,
  kDiscs = 5,
  kCurves = 6,
  kMovingTriangles = 7,
  kMeshes = 8  ///< the trees of role kTrianglesOfMesh
};
constexpr uint32_t kTreeRoleCount = 9;

struct TreeRecord {
  uint32_t role;  ///< TreeRole
  uint32_t width;
  uint32_t depth;
  uint32_t has_duplicates;
  uint32_t leaf_layout;  ///< LeafLayout
  uint32_t reserved;
  uint64_t node_count;
  uint64_t leaf_block_count;
  uint64_t used_slots;
  uint64_t used_lanes;
  uint64_t root;  ///< ChildReference
  uint64_t primitive_count;
  double sah_cost;
  float centre[3];
  float greatest_bound[3];
  float bounds_min[3];
  float bounds_max[3];
};
static_assert(sizeof(TreeRecord) == 128);

/// The numbers of kinds of geometries are pinned.
enum class SavedKind : uint32_t {
  kNone = 0,  ///< no geometry has this number
  kTriangleMesh = 1,
  kInstances = 2,
  kSpheres = 3,
  kDiscs = 4,
  kCurves = 5,
  kMovingMesh = 6,
  kMovingInstances = 7
};

enum : uint32_t {
  kCommitted = 1u << 0,  ///< the commit saw it
  kEnabled = 1u << 1,    ///< the next one will
  kHasIndices = 1u << 2,
  kHasMasks = 1u << 3,  ///< one an instance
  kHasOpacity = 1u << 4,
  kHasOpacityIndices = 1u << 5,
  kHasQuaternions = 1u << 6  ///< kiwami_quaternion_transform instead of matrices
};

/// A geometry of any kind. What its kind does not have is 0. Its buffers begin at multiples of 64.
/// They are, of triangle meshes: vertices, indices, opacity maps, the map of each triangle; of
/// moving ones: the vertices of all steps, indices; of shapes: points, normals (discs), indices
/// (curves); of instances: matrices, indices of scenes, masks; of moving ones the same, with the
/// transforms of all steps, step after step.
struct GeometryRecord {
  uint32_t kind;  ///< SavedKind
  uint32_t flags;
  uint32_t mask;
  uint32_t primitive_count;  ///< triangles, shapes or instances
  uint64_t point_count;      ///< vertices (of one step) or points
  uint32_t scene_count;      ///< that instances show
  uint32_t step_count;
  float time_begin, time_end;
  uint32_t opacity_level;
  uint32_t opacity_format;
  uint64_t opacity_map_count;
  uint64_t reserved;
};
static_assert(sizeof(GeometryRecord) == 64);

/// Of the instances of a scene that were committed.
struct InstancesRecord {
  float bounds_min[3];
  float bounds_max[3];
  float far_origin;
  uint32_t rebraid_mode;  ///< KIWAMI_REBRAID_*
  double rebraid_budget;
  double error_per_origin, error_fixed;  ///< HitError
};
static_assert(sizeof(InstancesRecord) == 56);

/// Of those that move.
struct MovingInstancesRecord {
  float bounds_min[3];
  float bounds_max[3];
  float far_origin;
  uint32_t reserved;
  double error_per_origin, error_fixed;  ///< HitError
};
static_assert(sizeof(MovingInstancesRecord) == 48);

/// A set of lights. Set 0 is the one that is saved; those that its instances show follow.
struct LightSetRecord {
  uint32_t width;
  uint32_t builder;  ///< KIWAMI_LIGHT_BUILDER_*
  uint32_t flags;    ///< KIWAMI_LIGHT_TREE_*
  float distant_probability;
  uint32_t node_count;
  uint32_t reserved;
  double build_seconds;
};
static_assert(sizeof(LightSetRecord) == 32);

struct SavedLightInstance {
  uint32_t set;
  float power_scale;
  float local_to_world[12];
  uint64_t link_mask;
};
static_assert(sizeof(SavedLightInstance) == 64);

struct ParameterRecord {
  uint32_t parameter;  ///< KIWAMI_PARAMETER_*; kOptimizer: value is one of KIWAMI_OPTIMIZER_*
  uint32_t reserved;
  double value;
};
static_assert(sizeof(ParameterRecord) == 16);
constexpr uint32_t kOptimizer = 0;

struct BvhRecord {
  uint32_t width;
  uint32_t leaf_width;
  uint32_t is_over_boxes;
  uint32_t reserved;
  double build_seconds;
};
static_assert(sizeof(BvhRecord) == 24);

}  // namespace kiwami::file
