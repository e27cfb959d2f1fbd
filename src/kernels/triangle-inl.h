// SPDX-License-Identifier: Apache-2.0
// One ray against the triangles of a leaf block, exactly.
//
// After S. Woop, C. Benthin, I. Wald, "Watertight Ray/Triangle Intersection", JCGT 2(1), 2013. It
// departs from the paper where it decides: a ray through an edge or a vertex belongs to exactly one
// of the triangles there. A vertex's sheared position depends on the ray and the vertex alone, so
// neighbours agree on it; from there on the signs of the edge functions are exact, and a sign of
// zero is taken at the query point moved by (epsilon, epsilon^2).
#pragma once

#include "kernels/ray-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// The three vertices of each lane in the ray's own frame, where the ray is the z axis.
template <int N>
struct ShearedBlock {
  float x[3][N], y[3][N], z[3][N];
};

/// The sign of the edge function p x q, never 0 unless p equals q: exact in double, since products
/// of floats are; where it is 0, the sign at the query point moved by (epsilon, epsilon^2).
inline int exact_edge_sign(float px, float py, float qx, float qy) {
  const double left = static_cast<double>(px) * static_cast<double>(qy);
  const double right = static_cast<double>(py) * static_cast<double>(qx);
  if (left != right) return left > right ? 1 : -1;
  if (py != qy) return py > qy ? 1 : -1;
  return qx > px ? 1 : qx < px ? -1 : 0;
}

template <int N>
inline bool is_inside_exactly(const ShearedBlock<N>& block, int lane) {
  const float ax = block.x[0][lane], ay = block.y[0][lane];
  const float bx = block.x[1][lane], by = block.y[1][lane];
  const float cx = block.x[2][lane], cy = block.y[2][lane];
  const int u = exact_edge_sign(cx, cy, bx, by);
  const int v = exact_edge_sign(ax, ay, cx, cy);
  const int w = exact_edge_sign(bx, by, ax, ay);
  return u != 0 && u == v && v == w;
}

/// Which lanes the ray passes through. In float without fused operations the sign of an edge
/// function is right or zero; min * max >= 0 says that no two signs differ (and is false for NaN),
/// == 0 that at least one has to be looked at exactly. A lane whose vertices all lie outside
/// [nearest, farthest] along the ray is left out: its distance lies between theirs.
template <int N, typename Probe>
inline uint32_t test_inside(const LeafBlock<N>& leaf, const ReadyRay& ray, vfloat<N> nearest,
                            vfloat<N> farthest, uint32_t lanes, ShearedBlock<N>& sheared,
                            Probe& probe) {
  const vfloat<N> origin_x = broadcast<N>(ray.origin[0]);
  const vfloat<N> origin_y = broadcast<N>(ray.origin[1]);
  const vfloat<N> origin_z = broadcast<N>(ray.origin[2]);
  const vfloat<N> shear_x = broadcast<N>(ray.shear[0]);
  const vfloat<N> shear_y = broadcast<N>(ray.shear[1]);
  const vfloat<N> shear_z = broadcast<N>(ray.shear_z);
  vfloat<N> x[3], y[3], z[3];
  for (int k = 0; k < 3; ++k) {
    const vfloat<N> along = load<N>(leaf.position[k][ray.axis[2]]) - origin_z;
    x[k] = (load<N>(leaf.position[k][ray.axis[0]]) - origin_x) - shear_x * along;
    y[k] = (load<N>(leaf.position[k][ray.axis[1]]) - origin_y) - shear_y * along;
    z[k] = shear_z * along;
  }
  const vfloat<N> u = x[2] * y[1] - y[2] * x[1];
  const vfloat<N> v = x[0] * y[2] - y[0] * x[2];
  const vfloat<N> w = x[1] * y[0] - y[1] * x[0];
  const vfloat<N> product = min(min(u, v), w) * max(max(u, v), w);
  const vfloat<N> zero = broadcast<N>(0.0f);
  uint32_t inside = less_equal(zero, product) & lanes;
  if (inside == 0) return 0;
  inside &= less_equal(min(min(z[0], z[1]), z[2]), farthest);
  inside &= less_equal(nearest, max(max(z[0], z[1]), z[2]));
  if (inside == 0) return 0;
  for (int k = 0; k < 3; ++k) {
    store(sheared.x[k], x[k]);
    store(sheared.y[k], y[k]);
    store(sheared.z[k], z[k]);
  }
  for (uint32_t undecided = equal(product, zero) & inside; undecided; undecided &= undecided - 1) {
    const int lane = __builtin_ctz(undecided);
    if (!is_inside_exactly(sheared, lane)) inside &= ~(1u << lane);
    probe.on_double_fallback();
  }
  return inside;
}

/// What is known of lanes that the ray passes through: the distance, and the edge functions in
/// double.
template <int N>
struct Crossings {
  float t[N];
  double v[N], w[N];  ///< edge functions of the sides at b and c
  double sum[N];      ///< of all three; positive for a triangle seen from its front
};

/// Computes one lane, in double from the float sheared vertices, t rounded once: the float forms
/// leave the triangle's own box on slivers or on grazing triangles. A lane after the other, since
/// most leaves have no more than one, and which of its vectors that is in cannot be predicted.
template <int N>
inline void compute_crossing(const ShearedBlock<N>& block, const ReadyRay& ray, int lane,
                             Crossings<N>& out) {
  const double ax = block.x[0][lane], ay = block.y[0][lane];
  const double bx = block.x[1][lane], by = block.y[1][lane];
  const double cx = block.x[2][lane], cy = block.y[2][lane];
  const double u = cx * by - cy * bx;
  const double v = ax * cy - ay * cx;
  const double w = bx * ay - by * ax;
  const double sum = (u + v) + w;
  const double along =
      (u * static_cast<double>(block.z[0][lane]) + v * static_cast<double>(block.z[1][lane])) +
      w * static_cast<double>(block.z[2][lane]);
  out.t[lane] = static_cast<float>(along / sum * inverse_of(ray.scale));
  out.v[lane] = v;
  out.w[lane] = w;
  out.sum[lane] = sum;
}

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
