// SPDX-License-Identifier: Apache-2.0
#include "wide/leaf_merging.h"

#include <algorithm>

namespace kiwami {
namespace {

uint16_t mask_of(uint32_t first, uint32_t size) {
  return static_cast<uint16_t>(((1u << size) - 1) << first);
}

/// The nodes that still take owners.
class Ring {
 public:
  Ring(uint32_t width, uint32_t capacity, uint32_t smallest, Memory& memory)
      : width_(width), smallest_(smallest), entries_(memory, std::max(capacity, 1u)) {}

  /// The node for an owner, and its first slot there.
  SharedPlace place(uint32_t size) {
    if (size + smallest_ > width_) return {opened_++, mask_of(0, size), 0};
    size_t chosen = find_exact(size);
    if (chosen == size_) chosen = size_ < entries_.size() ? open() : find_when_full(size);
    Entry& entry = entries_[chosen];
    const SharedPlace place = {entry.node, mask_of(entry.used, size),
                               static_cast<uint16_t>(entry.used)};
    entry.used += size;
    if (entry.used == width_) close(chosen);
    return place;
  }

  uint32_t opened() const { return opened_; }

 private:
  struct Entry {
    uint32_t node, used;
  };

  /// size_ where there is none. The oldest wins: its owners are the farthest behind.
  size_t find_exact(uint32_t size) const {
    size_t i = 0;
    while (i < size_ && entries_[i].used + size != width_) ++i;
    return i;
  }

  size_t find_when_full(uint32_t size) {
    size_t tightest = size_, fullest = 0;
    for (size_t i = 0; i < size_; ++i) {
      const uint32_t used = entries_[i].used;
      const bool fits = used + size + smallest_ <= width_;
      if (fits && (tightest == size_ || used > entries_[tightest].used)) tightest = i;
      if (used > entries_[fullest].used) fullest = i;
    }
    if (tightest != size_) return tightest;
    close(fullest);
    return open();
  }

  size_t open() {
    entries_[size_] = {opened_++, 0};
    return size_++;
  }

  void close(size_t index) {
    std::copy(entries_.begin() + index + 1, entries_.begin() + size_, entries_.begin() + index);
    --size_;
  }

  uint32_t width_;
  uint32_t smallest_;  ///< fewer free slots than this are of use to nobody
  uint32_t opened_ = 0;
  Array<Entry> entries_;  ///< by age
  size_t size_ = 0;
};

/// Replaces numbers in the order of first owners by numbers in the order of last owners.
void renumber_by_last_owner(SharedPlaces& shared, Memory& memory) {
  Array<uint32_t> last_owner(memory, shared.count);
  Array<uint32_t> number(memory, shared.count);
  for (size_t i = 0; i < shared.places.size(); ++i) {
    last_owner[shared.places[i].index] = static_cast<uint32_t>(i);
  }
  uint32_t next = 0;
  for (size_t i = 0; i < shared.places.size(); ++i) {
    const uint32_t index = shared.places[i].index;
    if (last_owner[index] == i) number[index] = next++;
  }
  for (SharedPlace& place : shared.places) place.index = number[place.index];
}

}  // namespace

SharedPlaces place_alone(const Array<uint8_t>& sizes, Memory& memory) {
  SharedPlaces shared{Array<SharedPlace>(memory, sizes.size()),
                      static_cast<uint32_t>(sizes.size())};
  for (size_t i = 0; i < sizes.size(); ++i) {
    shared.places[i] = {static_cast<uint32_t>(i), mask_of(0, sizes[i]), 0};
  }
  return shared;
}

SharedPlaces place_shared(const Array<uint8_t>& sizes, uint32_t width, uint32_t ring_size,
                          Memory& memory) {
  uint32_t smallest = width;
  for (const uint8_t size : sizes) smallest = std::min<uint32_t>(smallest, size);
  Ring ring(width, ring_size, smallest, memory);
  SharedPlaces shared{Array<SharedPlace>(memory, sizes.size()), 0};
  for (size_t i = 0; i < sizes.size(); ++i) shared.places[i] = ring.place(sizes[i]);
  shared.count = ring.opened();
  renumber_by_last_owner(shared, memory);
  return shared;
}

}  // namespace kiwami
