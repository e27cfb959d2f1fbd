// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "math/bounds.h"
#include "wide/instance_part.h"

namespace kiwami {

/// What a leaf of the top level refers to: an instance, or a part of one.
struct BraidReference {
  Bounds box;  ///< in the space of the top level
  InstanceStart start;
  float weight;  ///< about how many primitives are below
  bool is_root;  ///< a whole instance
};

/// The instances that references lead into.
class BraidSource {
 public:
  static constexpr uint32_t kMaxChildren = 16;

  /// Puts in what a reference may be replaced by; returns how many that are, 0 for a leaf.
  virtual uint32_t open(const BraidReference& reference,
                        BraidReference (&children)[kMaxChildren]) const = 0;

 protected:
  ~BraidSource() = default;
};

struct RebraidConfig {
  bool opens_roots_only = false;
  /// References beyond one an instance, as a part of the instances.
  double budget = 0.0;
  /// Opened where they reach over more than this part of their set.
  float least_extent = 0.1f;
  uint32_t bin_count = 16;
};

/// Opens the references of overlapping instances into those of their children, so that a tree over
/// them can keep apart what is below. The top-down pass of C. Benthin, S. Woop, I. Wald, A. Afra,
/// "Improved Two-Level BVHs using Partial Re-Braiding", High-Performance Graphics 2017. Departs
/// from it in that the sets which it divides decide what is opened alone: the tree is built over
/// the opened references afterwards, by any builder. And where the budget of a set does not suffice
/// for all that would be opened, the largest are. On one thread. Returns the references, set by
/// set.
Array<BraidReference> rebraid(Array<BraidReference> roots, const BraidSource& source,
                              const RebraidConfig& config, Memory& memory);

}  // namespace kiwami
