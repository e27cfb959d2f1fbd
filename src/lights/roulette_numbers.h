// SPDX-License-Identifier: Apache-2.0
// The random numbers that lights are compared with in a hierarchical Russian roulette, known by the
// least of a subtree before the others are: for leaves of a perfect binary tree. A value stands for
// the numbers of a subtree; none of them is below its least_bound(). divide() hands the least number
// on to one child, whose side it returns, as the first value; the least of the other one's is not
// known before settle(), which says early that admits(bound) is false where the bound has risen.
// accepts() compares the number of a leaf with a probability.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>

#include "lights/exponential.h"

namespace kiwami {

/// Random bits for number index: SplitMix64 (G. L. Steele, D. Lea, C. H. Flood, "Fast Splittable
/// Pseudorandom Number Generators", OOPSLA 2014).
inline uint64_t mixed_integer(uint64_t seed, uint64_t index) {
  uint64_t bits = seed + (index + 1) * 0x9E3779B97F4A7C15u;
  bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9u;
  bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBu;
  return bits ^ (bits >> 31);
}
/// The same over the receiver's random number.
inline uint64_t mixed_bits(double random, uint64_t index) {
  uint64_t bits;
  std::memcpy(&bits, &random, sizeof bits);
  return mixed_integer(bits, index);
}
inline double number_of_bits(uint64_t bits) { return static_cast<double>(bits >> 11) * 0x1p-53; }

/// Nodes' indices are beyond those of leaves.
constexpr uint64_t kNodeStream = uint64_t{1} << 40;

/// One random number for all (S. Ogaki's talk "Acceleration Data Structures for Ray Tracing", CEDEC
/// 2019, the lazy variant): a number R of as many bits as the tree has levels and a uniform number
/// xi give leaf i ((i xor R) + xi) / 2^levels. Each is uniform, together they fill the unit
/// interval evenly. Or, with R's bit another one at each node, the scrambling of A. B. Owen,
/// "Randomly Permuted (t, m, s)-Nets and (t, s)-Sequences", 1995.
class LazyNumbers {
 public:
  using Value = uint32_t;  ///< the first bits of the numbers of a subtree

  LazyNumbers(double random, uint32_t level_count, bool is_scrambled)
      : random_(random),
        count_(static_cast<double>(uint64_t{1} << level_count)),
        turn_(static_cast<uint32_t>(random * count_)),
        rest_(random * count_ - static_cast<double>(turn_)),
        is_scrambled_(is_scrambled) {}

  Value root() const { return 0; }
  double least_bound(Value value, uint32_t below) const {
    return (static_cast<double>(uint64_t{value} << below) + rest_) / count_;
  }
  bool accepts(Value value, double probability) const {
    return least_bound(value, 0) < probability;
  }
  uint32_t divide(Value value, size_t node, uint32_t below, Value (&children)[2]) const {
    children[0] = 2 * value;
    children[1] = 2 * value + 1;
    return is_scrambled_ ? static_cast<uint32_t>(mixed_bits(random_, kNodeStream + node) & 1)
                         : turn_ >> (below - 1) & 1;
  }
  template <typename Admits>
  bool settle(Value&, size_t, uint32_t, const Admits&) const {
    return true;  // its bound, which was admitted, is its least
  }

 private:
  double random_, count_;
  uint32_t turn_;
  double rest_;
  bool is_scrambled_;
};

/// Bits from hashes of the receiver's random number.
class HashedSource {
 public:
  HashedSource(double random) : random_(random) {}  // NOLINT(google-explicit-constructor)
  uint64_t bits(uint64_t index) const { return mixed_bits(random_, index); }

 private:
  double random_;
};

/// The index of the first number of a receiver.
constexpr uint64_t kFirstNumber = kNodeStream - 1;

/// Independent numbers (Tokuyoshi & Harada 2019): the least of a node's is that of one of its
/// children, each with the same probability since they have as many leaves; the other's is that of
/// as many uniform numbers which are not less. Kept as e = -ln(1 - u), exponentially distributed:
/// the least of n such numbers is one of them over n, and those above a bound are the bound plus as
/// many new ones, in place of the paper's powers. Places without a light have numbers, too. Source:
/// where bits come from, 53 for a number and a last one.
template <typename Source>
class IndependentNumbersOf {
 public:
  using Value = double;  ///< the least of a subtree, or of the one above until it is settled

  IndependentNumbersOf(const Source& source, uint32_t level_count)
      : source_(source),
        root_(exponential_of(number_of_bits(source.bits(kFirstNumber))) * share_of(level_count)) {}

  Value root() const { return root_; }
  /// 1 - exp(-e) is above the first four terms of its series, which rise up to there.
  double least_bound(Value value, uint32_t) const {
    const double e = value < 1.5 ? value : 1.5;
    return e * (1.0 - e * (1.0 / 2.0 - e * (1.0 / 6.0 - e * (1.0 / 24.0))));
  }
  bool accepts(Value value, double probability) const {
    // -ln(1 - p) is above p, and rarely between p and e.
    return value < probability || probability >= 1.0 || value < exponential_of(probability);
  }
  uint32_t divide(Value value, size_t node, uint32_t, Value (&children)[2]) const {
    children[0] = children[1] = value;
    return static_cast<uint32_t>(source_.bits(kNodeStream + node) & 1);
  }
  template <typename Admits>
  bool settle(Value& value, size_t parent, uint32_t below, const Admits& admits) const {
    const double u = number_of_bits(source_.bits(kNodeStream + parent));
    const double share = share_of(below);
    // -ln(1 - u) is not below u: most need no logarithm.
    if (!admits(least_bound(value + u * share, below))) return false;
    value += exponential_of(u) * share;
    return admits(least_bound(value, below));
  }

 private:
  /// 2^-below: each of so many leaves has the least number as likely.
  static double share_of(uint32_t below) {
    const uint64_t bits = uint64_t{1023 - below} << 52;
    double share;
    std::memcpy(&share, &bits, sizeof share);
    return share;
  }

  Source source_;
  double root_;
};
using IndependentNumbers = IndependentNumbersOf<HashedSource>;

}  // namespace kiwami
