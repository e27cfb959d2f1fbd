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

/// The numbers of sections are pinned.
enum class SectionType : uint32_t {
  kScene = 1,       ///< SceneRecord
  kTree = 2,        ///< nodes, then leaf blocks, as in memory
  kMeshes = 3,      ///< MeshRecord by geometry id
  kVertices = 4,    ///< three floats a vertex, of all meshes
  kIndices = 5,     ///< three uint32 a triangle, of all meshes that have them
  kParameters = 6,  ///< ParameterRecord
  kBvh = 7,         ///< BvhRecord
  kNodes = 8,       ///< kiwami_bvh_node
  kPrimitives = 9,  ///< uint32, the primitives in the order of the tree
  kSkipped = 10,    ///< uint32, what the build left out, rising
  kBoxes = 11       ///< six floats a box
};

enum : uint32_t {
  /// Who does not know the section must not use the file. Others can be passed over.
  kSectionRequired = 1u << 0
};

/// One line of the directory, which follows the header. Sections stand in the order of their lines
/// and do not overlap.
struct SectionEntry {
  uint32_t type;
  uint32_t version;
  uint32_t flags;
  uint32_t reserved;
  uint64_t offset;
  uint64_t bytes;
  uint64_t checksum;
  uint64_t reserved_bytes;
};
static_assert(sizeof(SectionEntry) == 48);

struct SceneRecord {
  uint32_t bvh_width;
  uint32_t leaf_width;
  uint32_t depth;
  uint32_t has_duplicates;
  uint32_t leaf_layout;  ///< LeafLayout
  uint32_t reserved;
  uint64_t node_count;
  uint64_t leaf_block_count;
  uint64_t used_slots;
  uint64_t used_lanes;
  uint64_t root;  ///< ChildReference
  uint64_t triangle_count;
  uint64_t skipped_count;
  double sah_cost;
  double build_seconds;
  float centre[3];
  float greatest_bound[3];
  float bounds_min[3];
  float bounds_max[3];
};
static_assert(sizeof(SceneRecord) == 144);

struct MeshRecord {
  uint64_t first_vertex;  ///< among those of kVertices
  uint64_t vertex_count;
  uint64_t first_index;  ///< the triangle among those of kIndices; kNoIndices: vertices 3i, 3i + 1,
                         ///< 3i + 2
  uint32_t triangle_count;  ///< 0: no geometry has this number
  uint32_t mask;
};
static_assert(sizeof(MeshRecord) == 32);
constexpr uint64_t kNoIndices = ~uint64_t{0};

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
