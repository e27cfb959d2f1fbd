// SPDX-License-Identifier: Apache-2.0
#include "io/tree_sections.h"

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "wide/check_references.h"

namespace kiwami::file {
namespace {

using ull = unsigned long long;

template <typename... Values>
[[noreturn]] void fail(const char* format, Values... values) {
  throw Error(KIWAMI_ERROR_INVALID_FILE, format, values...);
}

/// Boxes of instances end at twice KIWAMI_MAX_COORDINATE, with some padding where they move.
constexpr float kMaxPartCoordinate = 4.0f * KIWAMI_MAX_COORDINATE;

void copy(const Vec3f& from, float (&to)[3]) {
  for (int axis = 0; axis < 3; ++axis) to[axis] = from[axis];
}

Vec3f vector_of(const float (&from)[3]) { return {from[0], from[1], from[2]}; }

bool holds_triangles(TreeRole role) {
  return role == TreeRole::kTriangles || role == TreeRole::kTrianglesOfMesh;
}

void check_record(const TreeRecord& record, uint32_t scene, TreeRole previous,
                  const TreeRecord& first) {
  const uint32_t width = record.width;
  if ((width != 4 && width != 8 && width != 16) || width != first.width) {
    fail("a tree of scene %u is %u wide, expected 4, 8 or 16 as all of its trees", scene, width);
  }
  const auto role = static_cast<TreeRole>(record.role);
  // Roles rise, and only trees of meshes are several.
  if (record.role >= kTreeRoleCount || record.role < static_cast<uint32_t>(previous) ||
      (role == previous && role != TreeRole::kTrianglesOfMesh && &record != &first)) {
    fail("a tree of scene %u has role %u after %u, expected a higher one, less than %u", scene,
         record.role, static_cast<uint32_t>(previous), kTreeRoleCount);
  }
  const auto layout = static_cast<LeafLayout>(record.leaf_layout);
  const bool is_right = holds_triangles(role) ? record.leaf_layout == first.leaf_layout &&
                                                    (layout == LeafLayout::kTriangles ||
                                                     layout == LeafLayout::kIndices)
                                              : layout == LeafLayout::kIndices;
  if (!is_right) {
    fail(
        "the tree of role %u of scene %u has leaf layout %u, expected 0 or 1 as all of its trees "
        "of triangles, or else 1",
        record.role, scene, record.leaf_layout);
  }
}

/// A tree at the beginning of the bytes, its sizes checked, its contents not.
SavedTree parse_tree(const TreeRecord& record, std::span<const unsigned char> bytes) {
  SavedTree tree{};
  tree.width = record.width;
  tree.view.leaf_layout = static_cast<LeafLayout>(record.leaf_layout);
  // Neither product below can overflow once this holds.
  uint64_t size = ~uint64_t{0};
  if (record.node_count <= bytes.size() && record.leaf_block_count <= bytes.size()) {
    tree.node_count = record.node_count;
    tree.leaf_block_count = record.leaf_block_count;
    const WideTree sized = tree.tree();
    size = uint64_t{sized.node_bytes()} + sized.leaf_bytes();
  }
  if (size > bytes.size()) {
    fail("a tree has %zu bytes, expected those of %llu nodes and %llu leaf blocks", bytes.size(),
         ull{record.node_count}, ull{record.leaf_block_count});
  }
  tree.view.memory = bytes.data();
  tree.view.memory_bytes = size;
  tree.view.root.bits = record.root;
  tree.view.centre = vector_of(record.centre);
  tree.view.greatest_bound = vector_of(record.greatest_bound);
  tree.view.has_duplicates = record.has_duplicates != 0 ? 1 : 0;
  tree.used_slots = record.used_slots;
  tree.used_lanes = record.used_lanes;
  tree.primitive_count = record.primitive_count;
  tree.depth = record.depth;
  tree.sah_cost = record.sah_cost;
  // Of nothing they are turned inside out.
  tree.bounds = record.primitive_count == 0
                    ? Bounds::empty()
                    : Bounds{vector_of(record.bounds_min), vector_of(record.bounds_max)};
  if ((tree.primitive_count == 0) != (tree.view.root.mask() == 0)) {
    fail("a tree of %llu primitives has the root 0x%llx, expected one that is there where they are",
         ull{record.primitive_count}, ull{record.root});
  }
  return tree;
}

void check_bounds(const SavedTree& tree, float most) {
  for (int axis = 0; axis < 3 && tree.primitive_count != 0; ++axis) {
    const float lower = tree.bounds.lower[axis], upper = tree.bounds.upper[axis];
    // False where one is NaN.
    if (-most <= lower && lower <= upper && upper <= most) continue;
    fail("a tree reaches from %g to %g on axis %d, expected finite numbers",
         static_cast<double>(lower), static_cast<double>(upper), axis);
  }
}

}  // namespace

TreeRecord record_of(TreeRole role, const WideTree& tree, const Bounds& bounds,
                     uint64_t primitive_count) {
  TreeRecord record{};
  record.role = static_cast<uint32_t>(role);
  record.width = tree.width;
  record.depth = tree.depth;
  record.has_duplicates = tree.view.has_duplicates;
  record.leaf_layout = static_cast<uint32_t>(tree.leaf_layout);
  record.node_count = tree.node_count;
  record.leaf_block_count = tree.leaf_block_count;
  record.used_slots = tree.used_slots;
  record.used_lanes = tree.used_lanes;
  record.root = tree.view.root.bits;
  record.primitive_count = primitive_count;
  record.sah_cost = tree.sah_cost;
  copy(tree.view.centre, record.centre);
  copy(tree.view.greatest_bound, record.greatest_bound);
  copy(bounds.lower, record.bounds_min);
  copy(bounds.upper, record.bounds_max);
  return record;
}

SavedForest::SavedForest(const FileReader& reader, Memory& memory)
    : memory_(memory), first_tree_(memory, size_t{reader.scene_count()} + 1) {
  first_tree_[0] = 0;
  for (uint32_t scene = 0; scene < reader.scene_count(); ++scene) {
    const size_t count = reader.array<TreeRecord>(SectionType::kTreeRecords, scene).size();
    if (count == 0) fail("scene %u has no tree, expected one at least", scene);
    first_tree_[scene + 1] = first_tree_[scene] + count;
  }
  trees_ = Array<SavedTree>(memory, first_tree_[reader.scene_count()]);
  roles_ = Array<TreeRole>(memory, trees_.size());
  for (uint32_t scene = 0; scene < reader.scene_count(); ++scene) read_scene(reader, scene);
}

void SavedForest::keep_owned() {
  first_owned_ = Array<size_t>(memory_, trees_.size());
  size_t total = 0;
  for (size_t i = 0; i < trees_.size(); ++i) {
    first_owned_[i] = total;
    total += static_cast<size_t>(trees_[i].node_count + trees_[i].leaf_block_count);
  }
  owned_ = Array<uint16_t>(memory_, total);
}

void SavedForest::read_scene(const FileReader& reader, uint32_t scene) {
  const auto records = reader.array<TreeRecord>(SectionType::kTreeRecords, scene);
  const auto bytes = reader.array<unsigned char>(SectionType::kTrees, scene);
  size_t end = 0;
  TreeRole previous = TreeRole::kTriangles;
  for (size_t i = 0; i < records.size(); ++i) {
    check_record(records[i], scene, previous, records[0]);
    previous = static_cast<TreeRole>(records[i].role);
    if (i == 0 && previous != TreeRole::kTriangles) {
      fail("the first tree of scene %u has role %u, expected 0", scene, records[i].role);
    }
    const size_t begin = std::min(
        (end + kSectionAlignment - 1) / kSectionAlignment * kSectionAlignment, bytes.size());
    trees_[first_tree_[scene] + i] = parse_tree(records[i], bytes.subspan(begin));
    roles_[first_tree_[scene] + i] = previous;
    end = begin + static_cast<size_t>(trees_[first_tree_[scene] + i].view.memory_bytes);
  }
  if (bytes.size() - end >= kSectionAlignment) {
    fail("the trees of scene %u have %zu bytes, expected %zu", scene, bytes.size(), end);
  }
}

void SavedForest::check(const SavedTree& tree, std::span<const IdRange> ids,
                        const Parallel& parallel) {
  const float most = holds_triangles(role(tree)) ? KIWAMI_MAX_COORDINATE : kMaxPartCoordinate;
  check_bounds(tree, most);
  uint16_t* const owned = owned_.empty() ? nullptr : &owned_[first_owned_[index_of(tree)]];
  check_references(tree.tree(), {ids, most, owned}, memory_, parallel);
}

/// The number counts the trees that kernels see: that of the triangles, and parts that are not
/// empty. nullptr: there is none.
const SavedTree* SavedForest::tree_of(uint32_t scene, uint32_t number) const {
  for (const SavedTree& tree : of(scene)) {
    const TreeRole is = role(tree);
    if (is == TreeRole::kTriangles && number == 0) return &tree;
    if (holds_triangles(is) || tree.primitive_count == 0) continue;
    if (--number == 0) return &tree;
  }
  return nullptr;
}

bool SavedForest::owns(uint32_t scene, uint32_t number, ChildReference reference) const {
  const SavedTree* const saved = tree_of(scene, number);
  if (!saved || reference.mask() == 0) return false;
  const WideTree tree = saved->tree();
  const uint64_t number_there = tree.number_of(reference);
  const bool is_node = !reference.is_leaf();
  // A number that wraps around is too high, and one that was rounded down does not lead back.
  if (number_there >= (is_node ? tree.node_count : tree.leaf_block_count)) return false;
  const ChildReference back = is_node ? tree.node_reference(number_there, reference.mask())
                                      : tree.leaf_reference(number_there, reference.mask());
  if (!(back == reference)) return false;
  const uint64_t place = is_node ? number_there : tree.node_count + number_there;
  const size_t first = first_owned_[index_of(*saved)];
  return (reference.mask() & ~uint32_t{owned_[first + static_cast<size_t>(place)]}) == 0;
}

}  // namespace kiwami::file
