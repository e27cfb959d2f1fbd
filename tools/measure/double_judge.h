// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <kiwami/kiwami.h>

#include "scene/scene_file.h"

namespace kiwami::tools {

/// Where a ray passes a triangle, by double precision.
enum class Passage {
  kInside,   ///< farther from each edge than rounding in single precision can move it
  kOnEdge,   ///< so near to an edge that single precision may say either
  kOutside,  ///< farther from the triangle than rounding can move it
};

/// A triangle and a ray, in double precision from the same single precision numbers.
struct DoubleHit {
  Passage passage;
  double t;               ///< meaningless when `parallel`
  bool parallel;          ///< the triangle is seen exactly edge-on
  double distance_slack;  ///< how far single precision may move t
};

/// How two answers to one ray compare.
enum class Agreement {
  kBothMiss,
  kSamePrimitive,         ///< and t within 1e-5
  kSameDistance,          ///< other primitives whose t lie within 1e-5
  kReferenceDistanceOff,  ///< the same primitive; ours is nearer to double precision
  kOwnDistanceOff,        ///< the same primitive; the reference is nearer, both points on its plane
  kOnEdge,                ///< double precision finds the hit on an edge within rounding
  kAtRayEnd,              ///< at tmin or tmax within rounding
  kReferenceMissed,       ///< double precision finds our hit, which the reference missed
  kReferenceFalseHit,     ///< double precision finds no hit where the reference has one
  kWrong,                 ///< double precision contradicts us
};
constexpr int kAgreementCount = 10;
const char* agreement_name(Agreement agreement);

/// The triangle that a hit names, judged in double precision.
DoubleHit judge_triangle(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& hit);

/// Compares our answer with a reference's, and decides by double precision where they differ.
Agreement compare_hits(const SceneFile& scene, const kiwami_ray& ray, const kiwami_hit& own,
                       const kiwami_hit& reference);

}  // namespace kiwami::tools
