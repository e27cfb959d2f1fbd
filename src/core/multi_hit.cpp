// SPDX-License-Identifier: Apache-2.0
#include "core/multi_hit.h"

#include <algorithm>
#include <cstring>

#include "core/field_access.h"
#include "core/trace.h"
#include "math/float_environment.h"

namespace kiwami {
namespace {

/// Rays that one task traces.
constexpr size_t kBlockSize = kChunkSize;
/// Blocks that are traced before their hits move to the caller: enough for all threads, and a bound
/// for the memory that hits take on their way.
constexpr size_t kWaveBlocks = 64;
/// Hits of a ray for which a block has room at first.
constexpr size_t kFirstRoom = 4;

/// The hits of one block of rays, until it is known where they go.
class BlockHits {
 public:
  /// Traces the rays for their hits.
  void trace(const CommittedScene& scene, const RayBatch& batch, uint32_t max_hits) {
    used_ = 0;
    for (size_t done = 0; done < batch.count;) {
      HitRoom room{hits_.data(), keys_.data(), hits_.size(), used_, counts_ + done};
      const RayBatch rest{batch.rays + done * batch.ray_stride, batch.ray_stride, nullptr, 0,
                          batch.count - done};
      const size_t answered = scene.kernels().multi_hit(scene.view(), rest, max_hits, room);
      used_ = room.used;
      done += answered;
      if (answered < rest.count) grow(scene.memory(), batch.count);
    }
  }

  /// Traces the rays for the numbers of their hits alone.
  void count(const CommittedScene& scene, const RayBatch& batch, uint32_t max_hits) {
    used_ = 0;
    scene.kernels().all_hits(
        scene.view(), {batch.rays, batch.ray_stride, reinterpret_cast<unsigned char*>(counts_),
                       sizeof counts_[0], batch.count});
    if (max_hits == 0) return;
    for (size_t i = 0; i < batch.count; ++i) counts_[i] = std::min(counts_[i], max_hits);
  }

  const kiwami_hit* hits() const { return hits_.data(); }
  size_t hit_count() const { return used_; }
  /// Of ray i of the block.
  uint32_t count_of(size_t i) const { return counts_[i]; }

 private:
  void grow(Memory& memory, size_t ray_count) {
    const size_t size = std::max(kFirstRoom * ray_count, 2 * hits_.size());
    Array<kiwami_hit> larger(memory, size);
    if (used_) std::memcpy(larger.data(), hits_.data(), used_ * sizeof(kiwami_hit));
    keys_ = {};
    hits_ = std::move(larger);
    keys_ = Array<HitKey>(memory, size);
  }

  Array<kiwami_hit> hits_;
  Array<HitKey> keys_;
  size_t used_ = 0;
  uint32_t counts_[kBlockSize];
};

/// The parts of one call, of which Rays gives blocks as batches and Hits takes runs of hits.
template <typename Rays, typename Hits>
class MultiHitTrace {
 public:
  MultiHitTrace(const CommittedScene& scene, const Rays& rays, const Hits& hits, size_t count,
                const MultiHitRequest& request)
      : scene_(scene), rays_(rays), hits_(hits), count_(count), request_(request) {}

  uint64_t run() {
    const bool alone = is_alone(scene_.parallel(), count_, request_.on_calling_thread);
    const size_t wave = kBlockSize * (alone ? 1 : kWaveBlocks);
    request_.offsets[0] = 0;
    for (size_t begin = 0; begin < count_; begin += wave) {
      const size_t end = std::min(count_, begin + wave);
      if (alone) {
        const DefaultFloatEnvironment environment;
        trace_block(begin, end, blocks_[0]);
      } else {
        scene_.parallel().for_blocks(end - begin, kBlockSize, [&](size_t first, size_t last) {
          trace_block(begin + first, begin + last, blocks_[first / kBlockSize]);
        });
      }
      deliver(begin, end);
    }
    return request_.offsets[count_];
  }

 private:
  void trace_block(size_t begin, size_t end, BlockHits& block) {
    kiwami_ray scratch[kBlockSize];
    const RayBatch batch = rays_.block(begin, end, scratch);
    if (is_full_) {
      block.count(scene_, batch, request_.max_hits);
    } else {
      block.trace(scene_, batch, request_.max_hits);
    }
  }

  /// Gives the hits of a wave their places.
  void deliver(size_t begin, size_t end) {
    for (size_t i = begin; i < end; ++i) {
      const BlockHits& block = blocks_[(i - begin) / kBlockSize];
      request_.offsets[i + 1] = request_.offsets[i] + block.count_of((i - begin) % kBlockSize);
    }
    for (size_t first = begin; first < end; first += kBlockSize) {
      const BlockHits& block = blocks_[(first - begin) / kBlockSize];
      const uint64_t offset = request_.offsets[first];
      if (offset >= request_.hit_capacity) break;
      const uint64_t fitting =
          std::min<uint64_t>(block.hit_count(), request_.hit_capacity - offset);
      hits_.write(static_cast<size_t>(offset), block.hits(), static_cast<size_t>(fitting));
    }
    is_full_ = request_.offsets[end] >= request_.hit_capacity;
  }

  const CommittedScene& scene_;
  const Rays& rays_;
  const Hits& hits_;
  size_t count_;
  const MultiHitRequest& request_;
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
