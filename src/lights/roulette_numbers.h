// SPDX-License-Identifier: Apache-2.0
// The random numbers that lights are compared with in a hierarchical Russian roulette, known by the
// least of a subtree before the others are: for leaves of a perfect binary tree. A value stands for
// the numbers of a subtree; least() of it is their least, or, until settle() has been called, no
// more than that.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

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
  void settle(Value&, uint32_t) const {}
  double least(Value value, uint32_t below) const {
    return (static_cast<double>(uint64_t{value} << below) + rest_) / count_;
  }
  void divide(Value value, size_t node, uint32_t below, Value (&children)[2]) const {
    const uint32_t bit = is_scrambled_
                             ? static_cast<uint32_t>(mixed_bits(random_, kNodeStream + node) & 1)
                             : turn_ >> (below - 1) & 1;
    children[0] = 2 * value + bit;
    children[1] = 2 * value + (bit ^ 1);
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
/// as many uniform numbers which are not less. The least of 2^n numbers takes n square roots, in
/// place of the paper's power, so that it is the same to the bit everywhere; places without a light
/// have numbers, too. Source: where bits come from, 53 for a number and a last one.
template <typename Source>
class IndependentNumbersOf {
 public:
  /// The least number of a subtree, or that of the subtree above and the node there, of whose number
  /// this one is to be made: most subtrees are not visited whatever theirs is, so it is made late.
  struct Value {
    double least;
    uint64_t node;
  };

  IndependentNumbersOf(const Source& source, uint32_t level_count)
      : source_(source),
        root_(least_of_uniform(number_of_bits(source.bits(kFirstNumber)), level_count)) {}

  Value root() const { return {root_, kSettled}; }
  double least(const Value& value, uint32_t) const { return value.least; }
  void settle(Value& value, uint32_t below) const {
    if (value.node == kSettled) return;
    const uint64_t bits = source_.bits(kNodeStream + value.node);
    value.least += (1.0 - value.least) * least_of_uniform(number_of_bits(bits), below);
    value.node = kSettled;
  }
  /// Of a settled value.
  void divide(const Value& value, size_t node, uint32_t, Value (&children)[2]) const {
    const uint64_t bits = source_.bits(kNodeStream + node);
    children[bits & 1] = value;
    children[(bits & 1) ^ 1] = {value.least, node};
  }

  /// 1 - (1 - u)^(1 / 2^n), each square root of which is taken as 1 - sqrt(1 - u) = u / (1 + sqrt(1
  /// - u)), which keeps all digits of what is small.
  static double least_of_uniform(double u, uint32_t n) {
    for (; n != 0; --n) u /= 1.0 + std::sqrt(1.0 - u);
    return u;
  }

 private:
  static constexpr uint64_t kSettled = ~uint64_t{0};

  Source source_;
  double root_;
};
using IndependentNumbers = IndependentNumbersOf<HashedSource>;

}  // namespace kiwami
