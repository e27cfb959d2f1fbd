// SPDX-License-Identifier: Apache-2.0
#include "measure/baselines/baseline_peer.h"

#include <algorithm>
#include <chrono>
#include <limits>

#include "measure/baselines/structure.h"
#include "measure/parallel_blocks.h"

namespace kiwami::tools {
namespace {

constexpr size_t kRaysPerBlock = 4096;
constexpr float kInfinity = std::numeric_limits<float>::infinity();

class BaselineRun final : public PeerRun {
 public:
  BaselineRun(const Structure& structure, std::span<const kiwami_ray> rays, bool any_hit)
      : structure_(structure),
        rays_(rays),
        any_hit_(any_hit),
        hits_(any_hit ? 0 : rays.size()),
        occluded_(any_hit ? rays.size() : 0) {}

  void reset() override {
    std::fill(hits_.begin(), hits_.end(), BaselineHit{0.0f, 0.0f, 0.0f, KIWAMI_INVALID_ID});
    std::fill(occluded_.begin(), occluded_.end(), uint8_t{0});
  }

  void trace(uint32_t threads) override {
    parallel_blocks(threads, rays_.size(), kRaysPerBlock, [this](size_t first, size_t last) {
      const size_t count = last - first;
      const auto rays = rays_.subspan(first, count);
      if (any_hit_) {
        structure_.any_hits(rays, std::span(occluded_).subspan(first, count));
      } else {
        structure_.closest_hits(rays, std::span(hits_).subspan(first, count));
      }
    });
  }

  float distance(size_t i) const override {
    if (any_hit_) return occluded_[i] != 0 ? 0.0f : kInfinity;
    return hits_[i].triangle == KIWAMI_INVALID_ID ? kInfinity : hits_[i].t;
  }

 private:
  const Structure& structure_;
  std::span<const kiwami_ray> rays_;
  bool any_hit_;
  std::vector<BaselineHit> hits_;
  std::vector<uint8_t> occluded_;
};

class BinaryPeer final : public PeerScene {
 public:
  explicit BinaryPeer(const SceneFile& file) {
    const std::vector<Corners> triangles = list_triangles(file);
    const auto start = std::chrono::steady_clock::now();
    structure_ = build_binary_bvh(triangles);
    const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
    build_seconds_ = spent.count();
  }

  double build_seconds() const override { return build_seconds_; }
  uint64_t bytes() const override { return structure_->bytes(); }
  std::vector<PeerEntrance> entrances(std::span<const kiwami_ray> rays, bool any_hit,
                                      bool) const override {
    return {{"ray by ray", [this, rays, any_hit] { return make_run(*structure_, rays, any_hit); }}};
  }

 private:
  std::unique_ptr<Structure> structure_;
  double build_seconds_ = 0.0;
};

}  // namespace

std::unique_ptr<PeerRun> make_run(const Structure& structure, std::span<const kiwami_ray> rays,
                                  bool any_hit) {
  return std::make_unique<BaselineRun>(structure, rays, any_hit);
}

std::unique_ptr<PeerScene> make_binary_peer(const SceneFile& file) {
  return std::make_unique<BinaryPeer>(file);
}

}  // namespace kiwami::tools
