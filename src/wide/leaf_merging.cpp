// SPDX-License-Identifier: Apache-2.0
#include "wide/leaf_merging.h"

#include <algorithm>
#include <iterator>

namespace kiwami {
namespace {

uint16_t mask_of(uint32_t first, uint32_t size) {
  return static_cast<uint16_t>(((1u << size) - 1) << first);
}

constexpr uint32_t kMaxWidth = 16;
constexpr uint32_t kNone = ~0u;

/// A node that was opened. Where it was joined with another one, its slots moved to node, up by
/// shift. Where the ring gave it up, next is the one given up before it with as many used slots.
struct OpenedNode {
  uint32_t node, shift, next;
};

/// The nodes that still take owners.
class Ring {
 public:
  Ring(uint32_t width, uint32_t capacity, uint32_t smallest, Memory& memory)
      : width_(width),
        smallest_(smallest),
        entries_(memory, std::max(capacity, 1u)),
        opened_(memory) {
    std::fill(std::begin(given_up_), std::end(given_up_), kNone);
  }

  /// A node for an owner, and its first slot there: both may move while the ring is in use.
  SharedPlace place(uint32_t size) {
    if (size + smallest_ > width_) return {open_node(), mask_of(0, size), 0};
    const size_t exact = find_exact(size);
    const uint32_t given_up = exact == size_ ? take_given_up(width_ - size) : kNone;
    if (given_up != kNone) {
      return {given_up, mask_of(width_ - size, size), static_cast<uint16_t>(width_ - size)};
    }
    const size_t chosen = exact != size_ ? exact : choose_inexact(size);
    Entry& entry = entries_[chosen];
    const SharedPlace place = {entry.node, mask_of(entry.used, size),
                               static_cast<uint16_t>(entry.used)};
    use(entry, entry.used + size);
    if (entry.used == width_) close(chosen);
    return place;
  }

  /// Joins what is still open, as far as it fits.
  void finish() {
    while (join_pair(true) || join_pair(false)) continue;
    while (size_) give_up(size_ - 1);
  }

  /// Where a place has moved to.
  SharedPlace settle(SharedPlace place) const {
    while (opened_[place.index].node != place.index) {
      const OpenedNode& moved = opened_[place.index];
      place = {moved.node, static_cast<uint16_t>(place.mask << moved.shift),
               static_cast<uint16_t>(place.first + moved.shift)};
    }
    return place;
  }

  uint32_t opened() const { return static_cast<uint32_t>(opened_.size()); }

 private:
  struct Entry {
    uint32_t node, used;
  };

  size_t choose_inexact(uint32_t size) {
    if (size_ < entries_.size() || join_pair(true)) return open_entry();
    const size_t tightest = find_tightest(size);
    if (tightest != size_) return tightest;
    if (!join_pair(false)) give_up(find_fullest());
    return open_entry();
  }

  /// Gives an entry another number of used slots.
  void use(Entry& entry, uint32_t used) {
    --with_used_[entry.used];
    ++with_used_[used];
    entry.used = used;
  }

  /// The oldest entry that the owner fills; size_ where there is none.
  size_t find_exact(uint32_t size) const {
    if (with_used_[width_ - size] == 0) return size_;
    size_t i = 0;
    while (i < size_ && entries_[i].used + size != width_) ++i;
    return i;
  }

  /// The fullest entry that has room for the owner and then for another; size_ where there is none.
  size_t find_tightest(uint32_t size) const {
    size_t tightest = size_;
    for (size_t i = 0; i < size_; ++i) {
      const bool fits = entries_[i].used + size + smallest_ <= width_;
      if (fits && (tightest == size_ || entries_[i].used > entries_[tightest].used)) tightest = i;
    }
    return tightest;
  }

  size_t find_fullest() const {
    size_t fullest = 0;
    for (size_t i = 1; i < size_; ++i) {
      if (entries_[i].used > entries_[fullest].used) fullest = i;
    }
    return fullest;
  }

  /// Whether two entries together fill a node.
  bool has_exact_pair() const {
    if (with_used_[width_ / 2] > 1) return true;
    for (uint32_t used = 1; used < width_ / 2; ++used) {
      if (with_used_[used] != 0 && with_used_[width_ - used] != 0) return true;
    }
    return false;
  }

  /// Joins the two entries that together fill a node, or else the two that fill most of one.
  bool join_pair(bool must_fill) {
    if (must_fill && !has_exact_pair()) return false;
    size_t best_low = 0, best_high = 0;
    uint32_t best_used = must_fill ? width_ - 1 : 0;
    for (size_t high = 1; high < size_; ++high) {
      for (size_t low = 0; low < high; ++low) {
        const uint32_t used = entries_[low].used + entries_[high].used;
        if (used > width_ || used <= best_used) continue;
        best_used = used;
        best_low = low;
        best_high = high;
      }
    }
    if (best_high == 0) return false;
    move(entries_[best_high].node, entries_[best_low].node, entries_[best_low].used);
    use(entries_[best_low], best_used);
    close(best_high);
    if (best_used == width_) close(best_low);
    return true;
  }

  /// The last node given up with so many used slots; kNone where there is none.
  uint32_t take_given_up(uint32_t used) {
    const uint32_t node = given_up_[used];
    if (node != kNone) given_up_[used] = opened_[node].next;
    return node;
  }

  /// Joins an entry with a node that it fills, or lets it wait for an owner or node that fills it.
  void give_up(size_t index) {
    const Entry entry = entries_[index];
    const uint32_t partner = take_given_up(width_ - entry.used);
    if (partner != kNone) {
      move(entry.node, partner, width_ - entry.used);
    } else {
      opened_[entry.node].next = given_up_[entry.used];
      given_up_[entry.used] = entry.node;
    }
    close(index);
  }

  void move(uint32_t from, uint32_t to, uint32_t shift) { opened_[from] = {to, shift, kNone}; }

  uint32_t open_node() {
    const uint32_t node = opened();
    opened_.push_back({node, 0, kNone});
    return node;
  }

  size_t open_entry() {
    entries_[size_] = {open_node(), 0};
    ++with_used_[0];
    return size_++;
  }

  void close(size_t index) {
    --with_used_[entries_[index].used];
    std::copy(entries_.begin() + index + 1, entries_.begin() + size_, entries_.begin() + index);
    --size_;
  }

  uint32_t width_;
  uint32_t smallest_;     ///< fewer free slots than this are of use to nobody
  Array<Entry> entries_;  ///< by age
  size_t size_ = 0;
  GrowingArray<OpenedNode> opened_;
  uint32_t with_used_[kMaxWidth + 1] = {};  ///< by used slots: entries that have so many
  uint32_t given_up_[kMaxWidth + 1];        ///< by used slots: the last one given up
};

/// Gives the nodes that are left their final numbers, in the order of their last owners.
void number_by_last_owner(uint32_t opened, SharedPlaces& shared, Memory& memory) {
  Array<uint32_t> last_owner(memory, opened);
  Array<uint32_t> number(memory, opened);
  for (size_t i = 0; i < shared.places.size(); ++i) {
    last_owner[shared.places[i].index] = static_cast<uint32_t>(i);
  }
  uint32_t count = 0;
  for (size_t i = 0; i < shared.places.size(); ++i) {
    const uint32_t index = shared.places[i].index;
    if (last_owner[index] == i) number[index] = count++;
  }
  shared.used = Array<uint16_t>(memory, count);
  shared.used.fill_zero();
  for (SharedPlace& place : shared.places) {
    place.index = number[place.index];
    shared.used[place.index] = static_cast<uint16_t>(shared.used[place.index] | place.mask);
  }
}

}  // namespace

SharedPlaces place_alone(const Array<uint8_t>& sizes, Memory& memory) {
  SharedPlaces shared{Array<SharedPlace>(memory, sizes.size()),
                      Array<uint16_t>(memory, sizes.size())};
  for (size_t i = 0; i < sizes.size(); ++i) {
    shared.used[i] = mask_of(0, sizes[i]);
    shared.places[i] = {static_cast<uint32_t>(i), shared.used[i], 0};
  }
  return shared;
}

SharedPlaces place_shared(const Array<uint8_t>& sizes, uint32_t width, uint32_t ring_size,
                          Memory& memory) {
  uint32_t smallest = width;
  for (const uint8_t size : sizes) smallest = std::min<uint32_t>(smallest, size);
  Ring ring(width, ring_size, smallest, memory);
  SharedPlaces shared{Array<SharedPlace>(memory, sizes.size()), {}};
  for (size_t i = 0; i < sizes.size(); ++i) shared.places[i] = ring.place(sizes[i]);
  ring.finish();
  for (SharedPlace& place : shared.places) place = ring.settle(place);
  number_by_last_owner(ring.opened(), shared, memory);
  return shared;
}

}  // namespace kiwami
