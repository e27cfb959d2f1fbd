// SPDX-License-Identifier: Apache-2.0
// The trees of a file: a record of each, and their nodes and leaf blocks.
#pragma once

#include <span>

#include "core/saved_scene.h"
#include "io/file_reader.h"
#include "wide/check_references.h"
#include "wide/wide_tree.h"

namespace kiwami::file {

/// Of a tree that is saved; the bounds and the primitive count are those of what can be hit.
TreeRecord record_of(TreeRole role, const WideTree& tree, const Bounds& bounds,
                     uint64_t primitive_count);
inline TreeRecord record_of(TreeRole role, const PartTree& part) {
  return record_of(role, part.tree, part.bounds, part.primitive_count);
}

/// All trees of all scenes in a file.
class SavedForest {
 public:
  /// Throws Error(INVALID_FILE) where records and bytes do not belong together: sizes are checked,
  /// contents are not.
  SavedForest(const FileReader& reader, Memory& memory);

  /// Of a scene, by the order of their roles; the first one is that of the triangles.
  std::span<const SavedTree> of(uint32_t scene) const {
    return {trees_.data() + first_tree_[scene], first_tree_[scene + 1] - first_tree_[scene]};
  }
  TreeRole role(const SavedTree& tree) const { return roles_[index_of(tree)]; }

  /// Before the checks, where instances start in the midst of trees: owns is to be asked.
  void keep_owned();
  /// Checks what is in a tree that nobody vouches for, whose ids lie in the ranges: see
  /// check_references.
  void check(const SavedTree& tree, std::span<const IdRange> ids, const Parallel& parallel);
  /// The same of ids below a count.
  void check(const SavedTree& tree, uint64_t id_count, const Parallel& parallel) {
    const IdRange ids = {0, id_count};
    check(tree, {&ids, 1}, parallel);
  }
  /// After the checks of a scene: whether rays can start at a reference to a part of it. tree is as
  /// in InstanceStart.
  bool owns(uint32_t scene, uint32_t tree, ChildReference reference) const;

 private:
  size_t index_of(const SavedTree& tree) const {
    return static_cast<size_t>(&tree - trees_.data());
  }
  void read_scene(const FileReader& reader, uint32_t scene);
  const SavedTree* tree_of(uint32_t scene, uint32_t number) const;

  Memory& memory_;
  Array<size_t> first_tree_;  ///< by scene, and one more
  Array<SavedTree> trees_;
  Array<TreeRole> roles_;
  // The slots of each node and the lanes of each leaf block that are in use.
  Array<size_t> first_owned_;  ///< by tree
  Array<uint16_t> owned_;
};

}  // namespace kiwami::file
