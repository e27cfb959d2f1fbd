// SPDX-License-Identifier: Apache-2.0
// Lists of the hits of one ray: the nearest few, or all.
//
// After C. Gribble, A. Naveros, E. Kerzner, "Multi-Hit Ray Traversal", Journal of Computer Graphics
// Techniques 3(1), 2014: a buffer that is kept sorted by insertion. It departs from the paper in
// that keys of 8 bytes are sorted and hits stay where they are, and in the order, which is total:
// hits at one distance come by their numbers, so that a list does not depend on the order of
// visits, and a hit that is met twice (in trees with duplicates) is told by being equal.
#pragma once

#include "kernels/path-inl.h"

namespace kiwami {
namespace KIWAMI_ISA {
namespace {

/// Whether a comes before b, by (t, geometry, primitive).
inline bool is_before(const kiwami_hit* hits, HitKey a, HitKey b) {
  if (a.t != b.t) return a.t < b.t;
  return compare_numbers(hits[a.slot], hits[b.slot]) < 0;
}

inline bool are_same(const kiwami_hit& a, const kiwami_hit& b) {
  return a.t == b.t && compare_numbers(a, b) == 0;
}

/// Insertion sort: hits come nearly in order, since near boxes are visited first.
inline void sort_few(const kiwami_hit* hits, HitKey* keys, size_t count) {
  for (size_t i = 1; i < count; ++i) {
    const HitKey key = keys[i];
    size_t place = i;
    for (; place > 0 && is_before(hits, key, keys[place - 1]); --place) {
      keys[place] = keys[place - 1];
    }
    keys[place] = key;
  }
}

/// Moves the key at root down to its place in a heap whose parents come after their children.
inline void sift_down(const kiwami_hit* hits, HitKey* keys, size_t root, size_t count) {
  const HitKey key = keys[root];
  for (size_t child = 2 * root + 1; child < count; child = 2 * root + 1) {
    if (child + 1 < count && is_before(hits, keys[child], keys[child + 1])) ++child;
    if (!is_before(hits, key, keys[child])) break;
    keys[root] = keys[child];
    root = child;
  }
  keys[root] = key;
}

/// J. W. J. Williams, "Algorithm 232: Heapsort", Communications of the ACM 7(6), 1964: in place,
/// and never slow.
inline void sort_many(const kiwami_hit* hits, HitKey* keys, size_t count) {
  for (size_t root = count / 2; root-- > 0;) sift_down(hits, keys, root, count);
  for (size_t last = count; last-- > 1;) {
    const HitKey greatest = keys[0];
    keys[0] = keys[last];
    keys[last] = greatest;
    sift_down(hits, keys, 0, last);
  }
}

inline void sort_keys(const kiwami_hit* hits, HitKey* keys, size_t count) {
  constexpr size_t kFew = 32;
  if (count <= kFew) {
    sort_few(hits, keys, count);
  } else {
    sort_many(hits, keys, count);
  }
}

/// The nearest hits up to a limit, sorted at any time. They lie in the caller's slots.
template <typename Hit>
struct NearestHits {
  Hit* hits;
  HitKey* keys;
  uint32_t limit;
  uint32_t count;

  bool is_full() const { return count == limit; }
  /// The distance beyond which nothing is added; only of a full list.
  float farthest() const { return keys[count - 1].t; }

  /// Adds the hit at t that make() tells, unless it is too far or there. Returns true: there is
  /// always room.
  template <typename Make>
  bool add(float t, Make make) {
    if (is_full() && t > farthest()) return true;
    const Hit hit = make();
    uint32_t place = count;
    for (; place > 0 && t <= keys[place - 1].t; --place) {
      if (t < keys[place - 1].t) continue;
      const int order = compare_numbers(hit, hits[keys[place - 1].slot]);
      if (order == 0) return true;
      if (order > 0) break;
    }
    if (place == limit) return true;
    const uint32_t slot = is_full() ? keys[count - 1].slot : count++;
    for (uint32_t i = count - 1; i > place; --i) keys[i] = keys[i - 1];
    keys[place] = {t, slot};
    hits[slot] = hit;
    return true;
  }
};

/// All hits, or more of the nearest than a list that is always sorted should hold. They are
/// collected in the room; when twice the limit are there, the farther half goes.
struct CollectedHits {
  uint32_t limit;  ///< 0: none
  size_t capacity;
  size_t count;
  size_t sorted;  ///< the first ones, which are sorted and all different
  kiwami_hit* hits;
  HitKey* keys;

  void begin(const HitRoom& room) {
    limit = room.limit;
    capacity = room.capacity;
    if (limit != 0 && capacity / 2 > limit) capacity = 2 * size_t{limit};
    count = sorted = 0;
    hits = room.hits;
    keys = room.keys;
  }

  bool is_full() const { return limit != 0 && sorted == limit; }
  float farthest() const { return keys[sorted - 1].t; }

  /// Returns false where there is no room for it.
  template <typename Make>
  bool add(float t, Make make) {
    if (is_full() && t > farthest()) return true;
    if (count == capacity) {
      settle();
      if (count == capacity) return false;
      if (is_full() && t > farthest()) return true;
    }
    keys[count] = {t, static_cast<uint32_t>(count)};
    hits[count++] = make();
    return true;
  }

  /// Sorts, and drops repeats and what is beyond the limit.
  void settle() {
    sort_keys(hits, keys, count);
    reorder();
    size_t kept = 0;
    for (size_t i = 0; i < count && (limit == 0 || kept < limit); ++i) {
      if (kept > 0 && are_same(hits[kept - 1], hits[i])) continue;
      hits[kept] = hits[i];
      keys[kept] = {hits[i].t, static_cast<uint32_t>(kept)};
      ++kept;
    }
    count = sorted = kept;
  }

 private:
  /// Puts the hits into the order of their keys, along the cycles of the permutation.
  void reorder() {
    for (uint32_t first = 0; first < count; ++first) {
      if (keys[first].slot == first) continue;
      const kiwami_hit displaced = hits[first];
      uint32_t place = first;
      while (keys[place].slot != first) {
        const uint32_t source = keys[place].slot;
        hits[place] = hits[source];
        keys[place].slot = place;
        place = source;
      }
      hits[place] = displaced;
      keys[place].slot = place;
    }
  }
};

}  // namespace
}  // namespace KIWAMI_ISA
}  // namespace kiwami
