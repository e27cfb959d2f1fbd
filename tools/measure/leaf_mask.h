// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

namespace kiwami::tools {

/// A procedural leaf: whether a point of a triangle is a part of one that fills it, its corners
/// rounded off.
bool is_on_leaf(float u, float v);

/// The opacity micromap of a leaf, of two states: each micro-triangle is what its middle is.
std::vector<unsigned char> leaf_map(uint32_t level);

}  // namespace kiwami::tools
