// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/memory.h"
#include "lights/draw.h"

namespace kiwami {

/// Draws numbers in proportion to weights, in constant time: A. J. Walker, "An Efficient Method for
/// Generating Discrete Random Variables with General Distributions", TOMS 1977, built as in M. D.
/// Vose, "A Linear Algorithm for Generating Random Numbers with a Given Distribution", 1991.
class AliasTable {
 public:
  using Draw = kiwami::Draw;
  AliasTable() = default;
  /// weights are 0 or more, finite. Empty if all of them are 0.
  AliasTable(const Array<double>& weights, Memory& memory);

  bool empty() const { return entries_.empty(); }
  uint64_t bytes() const { return entries_.bytes(); }

  /// random is at least 0 and below 1. A number of weight 0 is never drawn.
  Draw draw(double random) const;
  double probability(uint32_t index) const { return entries_[index].probability; }

 private:
  struct Entry {
    double probability;
    float threshold;  ///< of the entry's own share, of 1
    uint32_t alias;   ///< whose is the rest
  };
  Array<Entry> entries_;
};

}  // namespace kiwami
