// SPDX-License-Identifier: Apache-2.0
#include "bvh/triangle_cover.h"

#include <algorithm>
#include <cmath>

#include "math/polygon.h"

namespace kiwami {
namespace {

/// Cuts the triangle at the sides of the boxes, as a kd-tree would be built, until each piece lies
/// in one box or in none.
class CoverTest {
 public:
  explicit CoverTest(double growth) : growth_(growth) {}

  bool is_covered(const ClippedTriangle& piece, std::span<Bounds> boxes) const {
    if (piece.is_empty()) return true;
    Bounds* const end = std::partition(boxes.data(), boxes.data() + boxes.size(),
                                       [&](const Bounds& box) { return overlaps(piece, box); });
    const std::span<Bounds> near(boxes.data(), end);
    const auto holds_piece = [&](const Bounds& box) { return contains(box, piece); };
    if (std::any_of(near.begin(), near.end(), holds_piece)) return true;
    Cut cut;
    for (const Bounds& box : near) {
      for (int axis = 0; axis < 3; ++axis) {
        cut.propose(piece, axis, lower_of(box, axis));
        cut.propose(piece, axis, upper_of(box, axis));
      }
    }
    // Boxes that reach the piece and have no side inside it would hold it.
    if (cut.axis < 0) return false;
    for (const double side : {1.0, -1.0}) {
      ClippedTriangle half = piece;
      half.clip(cut.axis, cut.plane, side);
      if (!is_covered(half, near)) return false;
    }
    return true;
  }

 private:
  /// The plane that divides the piece most evenly along some axis.
  struct Cut {
    int axis = -1;
    double plane = 0.0;
    double balance = 0.0;

    void propose(const ClippedTriangle& piece, int other_axis, double other) {
      const double below = other - piece.lower(other_axis), above = piece.upper(other_axis) - other;
      const double other_balance = std::min(below, above);
      if (!(other_balance > balance)) return;
      axis = other_axis;
      plane = other;
      balance = other_balance;
    }
  };

  double lower_of(const Bounds& box, int axis) const { return box.lower[axis] - growth_; }
  double upper_of(const Bounds& box, int axis) const { return box.upper[axis] + growth_; }

  bool overlaps(const ClippedTriangle& piece, const Bounds& box) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(lower_of(box, axis) < piece.upper(axis) || lower_of(box, axis) <= piece.lower(axis)) ||
          !(upper_of(box, axis) > piece.lower(axis) || upper_of(box, axis) >= piece.upper(axis))) {
        return false;
      }
    }
    return true;
  }

  bool contains(const Bounds& box, const ClippedTriangle& piece) const {
    for (int axis = 0; axis < 3; ++axis) {
      if (!(lower_of(box, axis) <= piece.lower(axis) && piece.upper(axis) <= upper_of(box, axis))) {
        return false;
      }
    }
    return true;
  }

  double growth_;
};

}  // namespace

bool is_covered(const Vec3f corner[3], const Vec3f& origin, std::span<Bounds> boxes) {
  double size = 0.0;
  for (int k = 0; k < 3; ++k) {
    for (int axis = 0; axis < 3; ++axis) {
      const double coordinate = std::fabs(corner[k][axis]);
      size = std::max(size, coordinate + std::fabs(origin[axis]));
    }
  }
  return CoverTest(size * 0x1p-36).is_covered(ClippedTriangle(corner, origin), boxes);
}

}  // namespace kiwami
