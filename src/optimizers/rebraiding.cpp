// SPDX-License-Identifier: Apache-2.0
#include "optimizers/rebraiding.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace kiwami {
namespace {

constexpr uint32_t kMaxBins = 32;
/// Sets of no more than this are left alone where no two of their boxes overlap.
constexpr size_t kFew = 4;

/// References at begin, and as many free places behind them as it may still be opened into.
struct Set {
  size_t begin, count, free;
};

/// Where a set is divided.
struct Division {
  int axis = -1;  ///< -1: there is no plane
  float scale = 0.0f, offset = 0.0f;
  uint32_t bin = 0;
  double cost = std::numeric_limits<double>::infinity();
};

float doubled_centroid(const BraidReference& reference, int axis) {
  return reference.box.lower[axis] + reference.box.upper[axis];
}

/// The half area in double precision.
double area_of(const Bounds& box) {
  if (box.is_empty()) return 0.0;
  const double x = double{box.upper.x} - double{box.lower.x};
  const double y = double{box.upper.y} - double{box.lower.y};
  const double z = double{box.upper.z} - double{box.lower.z};
  return x * y + y * z + z * x;
}

class Rebraiding {
 public:
  Rebraiding(Array<BraidReference> roots, const BraidSource& source, const RebraidConfig& config,
             Memory& memory)
      : source_(source), config_(config), memory_(memory), sets_(memory) {
    const auto free =
        static_cast<size_t>(std::lround(config.budget * static_cast<double>(roots.size())));
    const size_t count = roots.size();
    places_ = Array<BraidReference>(memory, count + free);
    std::copy(roots.begin(), roots.end(), places_.begin());
    sets_.push_back({0, count, free});
  }

  Array<BraidReference> run() {
    Array<BraidReference> done(memory_, places_.size());
    size_t done_count = 0;
    while (!sets_.empty()) {
      Set set = sets_.back();
      sets_.pop_back();
      if (is_worth_opening(set)) {
        open(set);
        divide(set);
      } else {
        std::copy_n(places_.begin() + set.begin, set.count, done.begin() + done_count);
        done_count += set.count;
      }
    }
    done.shrink(done_count);
    return done;
  }

 private:
  BraidReference* begin_of(const Set& set) { return places_.data() + set.begin; }

  /// Whether there is room, and two instances that may overlap.
  bool is_worth_opening(const Set& set) {
    if (set.free == 0 || set.count < 2) return false;
    const BraidReference* const references = begin_of(set);
    const auto is_of_first = [&](const BraidReference& reference) {
      return reference.start.instance == references[0].start.instance;
    };
    if (std::all_of(references, references + set.count, is_of_first)) return false;
    if (set.count > kFew) return true;
    for (size_t i = 0; i < set.count; ++i) {
      for (size_t k = i + 1; k < set.count; ++k) {
        if (!intersection_of(references[i].box, references[k].box).is_empty()) return true;
      }
    }
    return false;
  }

  Bounds box_of(const Set& set) {
    Bounds box = Bounds::empty();
    for (size_t i = 0; i < set.count; ++i) box.extend(begin_of(set)[i].box);
    return box;
  }

  /// Replaces what reaches over much of the set by its children, the largest first, for as long as
  /// there is room.
  void open(Set& set) {
    const Bounds box = box_of(set);
    const Vec3f extent = box.upper - box.lower;
    int axis = 0;
    for (int other = 1; other < 3; ++other) {
      if (extent[other] > extent[axis]) axis = other;
    }
    const float least = config_.least_extent * extent[axis];
    const auto size = [axis](const BraidReference& reference) {
      return reference.box.upper[axis] - reference.box.lower[axis];
    };
    Array<uint32_t> large(memory_, set.count);
    size_t large_count = 0;
    for (size_t i = 0; i < set.count; ++i) {
      const BraidReference& reference = begin_of(set)[i];
      if (config_.opens_roots_only && !reference.is_root) continue;
      if (size(reference) > least) large[large_count++] = static_cast<uint32_t>(i);
    }
    std::sort(large.begin(), large.begin() + large_count, [&](uint32_t a, uint32_t b) {
      const float size_a = size(begin_of(set)[a]), size_b = size(begin_of(set)[b]);
      return size_a != size_b ? size_a > size_b : a < b;
    });
    for (size_t i = 0; i < large_count && set.free != 0; ++i) open(set, large[i]);
  }

  void open(Set& set, size_t place) {
    BraidReference children[BraidSource::kMaxChildren];
    const uint32_t count = source_.open(begin_of(set)[place], children);
    if (count == 0 || count - 1 > set.free) return;
    begin_of(set)[place] = children[0];
    std::copy_n(children + 1, count - 1, begin_of(set) + set.count);
    set.count += count - 1;
    set.free -= count - 1;
  }

  /// Puts the two halves of a set onto the stack. Free places go along by weight.
  void divide(const Set& set) {
    BraidReference* const first = begin_of(set);
    BraidReference* const last = first + set.count;
    const Division division = find_division(set);
    BraidReference* middle = first;
    if (division.axis >= 0) {
      middle = std::stable_partition(first, last, [&](const BraidReference& reference) {
        return bin_of(reference, division) < division.bin;
      });
    }
    if (middle == first || middle == last) middle = first + set.count / 2;
    const double left = weight_of(first, middle), right = weight_of(middle, last);
    const auto left_count = static_cast<size_t>(middle - first);
    const size_t left_free = std::min(
        set.free, static_cast<size_t>(static_cast<double>(set.free) * left / (left + right)));
    std::copy_backward(middle, last, last + left_free);
    const Set halves[2] = {
        {set.begin, left_count, left_free},
        {set.begin + left_count + left_free, set.count - left_count, set.free - left_free}};
    sets_.push_back(halves[1]);
    sets_.push_back(halves[0]);
  }

  static double weight_of(const BraidReference* first, const BraidReference* last) {
    double weight = 0.0;
    for (; first != last; ++first) weight += double{first->weight};
    return weight;
  }

  uint32_t bin_of(const BraidReference& reference, const Division& division) const {
    const float position =
        (doubled_centroid(reference, division.axis) - division.offset) * division.scale;
    return static_cast<uint32_t>(
        std::clamp(position, 0.0f, static_cast<float>(config_.bin_count - 1)));
  }

  /// The plane of least cost by the surface area heuristic, over weights.
  Division find_division(const Set& set) {
    Division best;
    for (int axis = 0; axis < 3; ++axis) {
      float least = std::numeric_limits<float>::infinity(), greatest = -least;
      for (size_t i = 0; i < set.count; ++i) {
        least = std::min(least, doubled_centroid(begin_of(set)[i], axis));
        greatest = std::max(greatest, doubled_centroid(begin_of(set)[i], axis));
      }
      if (!(least < greatest)) continue;
      Division division;
      division.axis = axis;
      division.offset = least;
      division.scale = static_cast<float>(config_.bin_count) / (greatest - least);
      choose_bin(set, division);
      if (division.cost < best.cost) best = division;
    }
    return best;
  }

  void choose_bin(const Set& set, Division& division) {
    Bounds boxes[kMaxBins];
    double weights[kMaxBins] = {};
    std::fill_n(boxes, kMaxBins, Bounds::empty());
    for (size_t i = 0; i < set.count; ++i) {
      const BraidReference& reference = begin_of(set)[i];
      const uint32_t bin = bin_of(reference, division);
      boxes[bin].extend(reference.box);
      weights[bin] += double{reference.weight};
    }
    double right_costs[kMaxBins];
    Bounds box = Bounds::empty();
    double weight = 0.0;
    for (uint32_t bin = config_.bin_count; bin-- > 1;) {
      box.extend(boxes[bin]);
      weight += weights[bin];
      right_costs[bin] = area_of(box) * weight;
    }
    box = Bounds::empty();
    weight = 0.0;
    for (uint32_t bin = 1; bin < config_.bin_count; ++bin) {
      box.extend(boxes[bin - 1]);
      weight += weights[bin - 1];
      const double cost = area_of(box) * weight + right_costs[bin];
      if (cost < division.cost) {
        division.cost = cost;
        division.bin = bin;
      }
    }
  }

  const BraidSource& source_;
  const RebraidConfig config_;
  Memory& memory_;
  Array<BraidReference> places_;
  GrowingArray<Set> sets_;
};

}  // namespace

Array<BraidReference> rebraid(Array<BraidReference> roots, const BraidSource& source,
                              const RebraidConfig& config, Memory& memory) {
  if (roots.empty()) return roots;
  return Rebraiding(std::move(roots), source, config, memory).run();
}

}  // namespace kiwami
