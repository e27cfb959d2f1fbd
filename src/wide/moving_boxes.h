// SPDX-License-Identifier: Apache-2.0
// The boxes of a tree over what moves, as kernels see them. Plain data.
#pragma once

#include "wide/time_steps.h"

namespace kiwami {

/// Boxes of the children of a node that grow linearly over a segment of time: those at its start,
/// then those at its end, each as in WideNode.
template <int N>
struct alignas(64) MotionBounds {
  float bounds[2][3][2][N];
};
static_assert(sizeof(MotionBounds<4>) == 192 && sizeof(MotionBounds<8>) == 384 &&
              sizeof(MotionBounds<16>) == 768);

/// What a tree over what moves lacks: its own boxes are of no time in particular.
struct MovingBoxes {
  TimeSteps time;
  const unsigned char* bounds;  ///< MotionBounds<N> of each node, segment after segment
  uint64_t node_count;
};

}  // namespace kiwami
