// SPDX-License-Identifier: Apache-2.0
#include "core/multi_hit.h"

#include <algorithm>
#include <cstring>

#include "core/field_access.h"
#include "core/general_hits.h"
#include "math/float_environment.h"

namespace kiwami {
namespace {

/// Rays that one task traces: enough for kernels that trace rays together, few enough that their
/// lists stay in the caches.
constexpr size_t kBlockSize = 1024;
/// Blocks that are traced before their hits move to the caller: enough for all threads, and a bound
/// for the memory that hits take on their way.
constexpr size_t kWaveBlocks = 32;
/// The longest list that is kept sorted by insertion.
constexpr uint32_t kMostInserted = 64;
/// Where more are wanted: a list that is seldom full. Rays that fill it are traced again.
constexpr uint32_t kUsualLength = 16;

/// The hits of one block of rays, until it is known where they go.
class BlockHits {
 public:
  /// Traces the rays for their hits by the plain kernels.
  void trace(const CommittedScene& scene, const RayBatch& batch, uint32_t max_hits) {
    const bool is_short = max_hits != 0 && max_hits <= kMostInserted;
    limit_ = is_short ? max_hits : kUsualLength;
    long_count_ = 0;
    make_room(scene.memory(), batch.count);
    scene.kernels().multi_hit.nearest(scene.view(), counting(batch),
                                      {hits_.data(), keys_.data(), limit_});
    for (size_t i = 0; i < batch.count; ++i) {
      is_long_[i] = !is_short && counts_[i] == limit_ ? 1 : 0;
      if (is_long_[i] != 0) trace_long(scene, batch, i, max_hits);
    }
  }

  /// Traces the rays for their hits by the general kernels; keeps the numbers alone if not told
  /// otherwise.
  void trace_generally(const CommittedScene& scene, const RayBatch& batch,
                       const QueryOptions& options, uint32_t max_hits, bool keeps) {
    limit_ = 0;
    is_general_ = true;
    make_room(scene.memory(), batch.count);
    general_.clear();
    for (size_t i = 0; i < batch.count; ++i) {
      if (options.has_failed_callback()) {
        counts_[i] = 0;
        continue;
      }
      const RayBatch ray{batch.rays + i * batch.ray_stride, batch.ray_stride, nullptr, 0, 1};
      counts_[i] = general_.trace(scene, ray, options.from(i), max_hits, keeps);
    }
  }

  /// Traces the rays for the numbers of their hits alone.
  void count(const CommittedScene& scene, const RayBatch& batch, const QueryOptions& options,
             uint32_t max_hits) {
    limit_ = 0;
    make_room(scene.memory(), batch.count);
    kAllHits.answer(scene, counting(batch), options);
    if (max_hits == 0) return;
    for (size_t i = 0; i < batch.count; ++i) counts_[i] = std::min(counts_[i], max_hits);
  }

  /// Of ray i of the block.
  uint32_t count_of(size_t i) const { return counts_[i]; }

  /// Calls write(hits, paths, count) for runs of the hits of the first ray_count rays, in order;
  /// paths are null where no hit is in an instance.
  template <typename Write>
  void deliver(size_t ray_count, Write write) const {
    if (is_general_) {
      size_t count = 0;
      for (size_t i = 0; i < ray_count; ++i) count += counts_[i];
      write(general_.hits(), general_.paths(), count);
      return;
    }
    const InstancePath* const no_paths = nullptr;
    kiwami_hit sorted[kMostInserted];
    const kiwami_hit* next_long = long_hits_.data();
    for (size_t i = 0; i < ray_count; ++i) {
      const uint32_t count = counts_[i];
      if (is_long_[i] != 0) {
        write(next_long, no_paths, count);
        next_long += count;
        continue;
      }
      const size_t first = i * limit_;
      for (uint32_t k = 0; k < count; ++k) sorted[k] = hits_[first + keys_[first + k].slot];
      if (count) write(sorted, no_paths, count);
    }
  }

 private:
  void make_room(Memory& memory, size_t ray_count) {
    if (counts_.size() < ray_count) {
      counts_ = Array<uint32_t>(memory, ray_count);
      is_long_ = Array<uint8_t>(memory, ray_count);
    }
    const size_t slots = ray_count * limit_;
    if (hits_.size() < slots) hits_ = Array<kiwami_hit>(memory, slots);
    if (keys_.size() < slots) keys_ = Array<HitKey>(memory, slots);
  }

  RayBatch counting(const RayBatch& rays) {
    return {rays.rays, rays.ray_stride, reinterpret_cast<unsigned char*>(counts_.data()),
            sizeof counts_[0], rays.count};
  }

  /// Traces ray i for all that is wanted of it, in as much memory as that takes.
  void trace_long(const CommittedScene& scene, const RayBatch& batch, size_t i, uint32_t max_hits) {
    const RayBatch ray{batch.rays + i * batch.ray_stride, batch.ray_stride, nullptr, 0, 1};
    for (;;) {
      const size_t left = long_hits_.size() - long_count_;
      const size_t count = scene.kernels().multi_hit.many(
          scene.view(), ray,
          {long_hits_.data() + long_count_, long_keys_.data() + long_count_, left, max_hits});
      if (count <= left) {
        counts_[i] = static_cast<uint32_t>(count);
        long_count_ += count;
        return;
      }
      grow_long(scene.memory());
    }
  }

  void grow_long(Memory& memory) {
    const size_t size = std::max(size_t{4} * kUsualLength, 2 * long_hits_.size());
    Array<kiwami_hit> larger(memory, size);
    if (long_count_) std::memcpy(larger.data(), long_hits_.data(), long_count_ * sizeof larger[0]);
    Array<HitKey> keys(memory, size);
    long_hits_ = std::move(larger);
    long_keys_ = std::move(keys);
  }

  bool is_general_ = false;
  GeneralHits general_;
  Array<kiwami_hit> hits_;  ///< limit_ slots a ray
  Array<HitKey> keys_;
  Array<kiwami_hit> long_hits_;  ///< of the rays with more, one after the other
  Array<HitKey> long_keys_;
  size_t long_count_ = 0;
  uint32_t limit_ = 0;
  Array<uint32_t> counts_;  ///< of each ray
  Array<uint8_t> is_long_;
};

/// The parts of one call, of which Rays gives blocks as batches and Hits takes runs of hits.
template <typename Rays, typename Hits>
class MultiHitTrace {
 public:
  MultiHitTrace(const CommittedScene& scene, const Rays& rays, const Hits& hits, size_t count,
                const MultiHitRequest& request)
      : scene_(scene),
        rays_(rays),
        hits_(hits),
        count_(count),
        request_(request),
        options_(watch_.watched(kernel_options(request.trace.options))),
        is_general_(!scene.is_plain() || !options_.is_empty()),
        is_alone_(is_alone(scene.parallel(), count, request.trace.on_calling_thread)) {}

  uint64_t run() {
    const size_t wave = kBlockSize * (is_alone_ ? 1 : kWaveBlocks);
    request_.offsets[0] = 0;
    for (size_t begin = 0; begin < count_; begin += wave) {
      const size_t end = std::min(count_, begin + wave);
      for_blocks(begin, end, [&](size_t first, size_t last, BlockHits& block) {
        trace_block(first, last, block);
      });
      for (size_t i = begin; i < end; ++i) {
        const BlockHits& block = blocks_[(i - begin) / kBlockSize];
        request_.offsets[i + 1] = request_.offsets[i] + block.count_of((i - begin) % kBlockSize);
      }
      watch_.check();
      if (is_full_) continue;
      for_blocks(begin, end, [&](size_t first, size_t last, const BlockHits& block) {
        deliver(first, last, block);
      });
      is_full_ = request_.offsets[end] >= request_.hit_capacity;
    }
    return request_.offsets[count_];
  }

 private:
  /// Calls body(begin, end, block) for the blocks of a wave.
  template <typename Body>
  void for_blocks(size_t begin, size_t end, Body body) {
    if (is_alone_) {
      const DefaultFloatEnvironment environment;
      body(begin, end, blocks_[0]);
      return;
    }
    scene_.parallel().for_blocks(end - begin, kBlockSize, [&](size_t first, size_t last) {
      body(begin + first, begin + last, blocks_[first / kBlockSize]);
    });
  }

  void trace_block(size_t begin, size_t end, BlockHits& block) {
    kiwami_ray scratch[kBlockSize];
    const RayBatch batch = rays_.block(begin, end, scratch);
    const QueryOptions options = options_.from(begin);
    // A filter sees the hits in their order, also where they are only counted.
    if (is_full_ && !options.filter) {
      block.count(scene_, batch, options, request_.max_hits);
    } else if (is_general_) {
      block.trace_generally(scene_, batch, options, request_.max_hits, !is_full_);
    } else {
      block.trace(scene_, batch, request_.max_hits);
    }
  }

  /// Writes what fits of a block to its place.
  void deliver(size_t begin, size_t end, const BlockHits& block) const {
    uint64_t offset = request_.offsets[begin];
    block.deliver(
        end - begin, [&](const kiwami_hit* hits, const InstancePath* paths, size_t count) {
          if (offset < request_.hit_capacity) {
            const auto first = static_cast<size_t>(offset);
            const auto fitting =
                static_cast<size_t>(std::min<uint64_t>(count, request_.hit_capacity - offset));
            hits_.write(first, hits, fitting);
            if (request_.trace.options.instance_paths) write_paths(first, paths, fitting);
          }
          offset += count;
        });
  }

  void write_paths(size_t first, const InstancePath* paths, size_t count) const {
    const QueryOptions& options = request_.trace.options;
    for (size_t i = 0; i < count; ++i) {
      uint32_t numbers[KIWAMI_MAX_INSTANCE_DEPTH];
      for (uint32_t level = 0; level < KIWAMI_MAX_INSTANCE_DEPTH; ++level) {
        const bool is_there = paths && level < paths[i].depth;
        numbers[level] = is_there ? paths[i].number[level] : KIWAMI_INVALID_ID;
      }
      std::memcpy(options.instance_paths + (first + i) * options.instance_path_stride, numbers,
                  sizeof numbers);
    }
  }

  /// What kernels are told: they write no paths.
  static QueryOptions kernel_options(QueryOptions options) {
    options.instance_paths = nullptr;
    return options;
  }

  const CommittedScene& scene_;
  const Rays& rays_;
  const Hits& hits_;
  size_t count_;
  const MultiHitRequest& request_;
  CallbackWatch watch_;
  QueryOptions options_;
  bool is_general_;
  bool is_alone_;
  bool is_full_ = request_.hit_capacity == 0;  ///< what comes is only counted
  BlockHits blocks_[kWaveBlocks];
};

struct RayArray {
  const RayBatch& batch;

  RayBatch block(size_t begin, size_t end, kiwami_ray*) const {
    return {batch.rays + begin * batch.ray_stride, batch.ray_stride, nullptr, 0, end - begin};
  }
};

struct RayColumns {
  const kiwami_ray_fields& fields;

  RayBatch block(size_t begin, size_t end, kiwami_ray* scratch) const {
    gather_rays(fields, begin, end - begin, scratch);
    return {reinterpret_cast<const unsigned char*>(scratch), sizeof(kiwami_ray), nullptr, 0,
            end - begin};
  }
};

struct HitArray {
  kiwami_hit* hits;

  void write(size_t first, const kiwami_hit* from, size_t count) const {
    if (count) std::memcpy(static_cast<void*>(hits + first), from, count * sizeof(kiwami_hit));
  }
};

struct HitColumns {
  const kiwami_hit_fields& fields;

  void write(size_t first, const kiwami_hit* from, size_t count) const {
    scatter_hits(from, first, count, fields);
  }
};

}  // namespace

uint64_t trace_multi_hit(const CommittedScene& scene, const RayBatch& rays, kiwami_hit* hits,
                         const MultiHitRequest& request) {
  const RayArray source{rays};
  const HitArray target{hits};
  return MultiHitTrace<RayArray, HitArray>(scene, source, target, rays.count, request).run();
}

uint64_t trace_multi_hit(const CommittedScene& scene, const kiwami_ray_fields& rays, size_t count,
                         const kiwami_hit_fields& hits, const MultiHitRequest& request) {
  const RayColumns source{rays};
  const HitColumns target{hits};
  return MultiHitTrace<RayColumns, HitColumns>(scene, source, target, count, request).run();
}

}  // namespace kiwami
