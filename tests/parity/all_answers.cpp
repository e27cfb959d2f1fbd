// SPDX-License-Identifier: Apache-2.0
#include "parity/all_answers.h"

#include <algorithm>
#include <cstring>
#include <stdexcept>

#include "kiwami/instances.h"
#include "support/library.h"

namespace kiwami_tests {
namespace {

template <typename Record>
NamedAnswers named(const std::string& call, const std::vector<Record>& records, size_t size) {
  NamedAnswers answers{call, size, std::vector<unsigned char>(records.size() * sizeof(Record))};
  if (!records.empty()) std::memcpy(answers.bytes.data(), records.data(), answers.bytes.size());
  return answers;
}

template <typename Record>
NamedAnswers named(const std::string& call, const std::vector<Record>& records) {
  return named(call, records, sizeof(Record));
}

kiwami_query default_query() {
  kiwami_query query;
  check(kiwami_query_init(&query, sizeof query));
  return query;
}

/// Rejects every third primitive of every other instance.
int32_t reject_some(void*, const kiwami_filter_candidate* candidate) {
  const uint32_t sum = candidate->hit.primitive_id + candidate->instance_path[0] % 2;
  return sum % 3 == 0 ? KIWAMI_FILTER_REJECT : KIWAMI_FILTER_ACCEPT;
}

/// The calls with one query, under a name.
class Caller {
 public:
  Caller(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays, kiwami_query query,
         std::string name, std::vector<NamedAnswers>& answers)
      : scene_(scene), rays_(rays), query_(query), name_(std::move(name)), answers_(answers) {}

  std::vector<kiwami_hit> closest() {
    std::vector<kiwami_hit> hits(rays_.size());
    std::vector<uint32_t> paths(rays_.size() * kDepth);
    query_.instance_paths = paths.data();
    check(kiwami_closest_hit(scene_, rays_.data(), 0, hits.data(), 0, hits.size(), &query_));
    query_.instance_paths = nullptr;
    answers_.push_back(named(name_ + "closest hits", hits));
    answers_.push_back(named(name_ + "paths", paths, kDepth * sizeof(uint32_t)));
    return hits;
  }
  std::vector<uint8_t> any() {
    std::vector<uint8_t> any(rays_.size());
    check(kiwami_any_hit(scene_, rays_.data(), 0, any.data(), 0, any.size(), &query_));
    answers_.push_back(named(name_ + "any hits", any));
    return any;
  }
  void counts() {
    std::vector<uint32_t> counts(rays_.size());
    check(kiwami_count_hits(scene_, rays_.data(), 0, counts.data(), 0, counts.size(), &query_));
    answers_.push_back(named(name_ + "counts", counts));
  }
  void lists(uint32_t max_hits) {
    const std::string name = name_ + "lists of " + std::to_string(max_hits);
    std::vector<uint64_t> offsets(rays_.size() + 1);
    std::vector<kiwami_hit> hits(rays_.size() * 64);
    std::vector<uint32_t> paths;
    for (;;) {
      paths.resize(hits.size() * kDepth);
      query_.instance_paths = paths.data();
      const kiwami_result result =
          kiwami_multi_hit(scene_, rays_.data(), 0, rays_.size(), max_hits, hits.data(),
                           hits.size(), offsets.data(), &query_);
      query_.instance_paths = nullptr;
      if (offsets.back() <= hits.size()) {
        check(result);
        break;
      }
      hits.resize(offsets.back());
    }
    hits.resize(offsets.back());
    paths.resize(offsets.back() * kDepth);
    answers_.push_back(named(name + ": offsets", offsets));
    answers_.push_back(named(name + ": hits", hits));
    answers_.push_back(named(name + ": paths", paths, kDepth * sizeof(uint32_t)));
  }

 private:
  static constexpr size_t kDepth = KIWAMI_MAX_INSTANCE_DEPTH;

  const kiwami_scene* scene_;
  const std::vector<kiwami_ray>& rays_;
  kiwami_query query_;
  std::string name_;
  std::vector<NamedAnswers>& answers_;
};

void check_single_rays(const kiwami_scene* scene, const std::vector<kiwami_ray>& rays,
                       const std::vector<kiwami_hit>& hits, const std::vector<uint8_t>& any) {
  for (size_t i = 0; i < rays.size(); i += 7) {
    kiwami_hit hit;
    uint8_t is_hit;
    check(kiwami_closest_hit(scene, &rays[i], 0, &hit, 0, 1, nullptr));
    check(kiwami_any_hit(scene, &rays[i], 0, &is_hit, 0, 1, nullptr));
    if (std::memcmp(&hit, &hits[i], sizeof hit) != 0 || is_hit != any[i]) {
      throw std::runtime_error("ray " + std::to_string(i) + " alone is answered otherwise");
    }
  }
}

}  // namespace

std::vector<NamedAnswers> all_answers(const kiwami_scene* scene,
                                      const std::vector<kiwami_ray>& rays) {
  std::vector<NamedAnswers> answers;
  Caller plain(scene, rays, default_query(), "", answers);
  const std::vector<kiwami_hit> hits = plain.closest();
  const std::vector<uint8_t> any = plain.any();
  plain.counts();
  plain.lists(3);
  plain.lists(0);
  check_single_rays(scene, rays, hits, any);

  kiwami_query query = default_query();
  query.filter = reject_some;
  Caller filtered(scene, rays, query, "filtered ", answers);
  filtered.closest();
  filtered.any();
  filtered.counts();

  std::vector<kiwami_exclusion> exclusions;
  for (const kiwami_hit& hit : hits) {
    exclusions.push_back({hit.primitive_id, hit.geometry_id, hit.instance_id});
  }
  query = default_query();
  query.exclusions = exclusions.data();
  Caller excluding(scene, rays, query, "excluding ", answers);
  excluding.closest();
  excluding.any();
  return answers;
}

std::string difference(const std::vector<NamedAnswers>& a, const std::vector<NamedAnswers>& b) {
  for (size_t i = 0; i < a.size(); ++i) {
    if (a[i].bytes == b[i].bytes) continue;
    if (a[i].bytes.size() != b[i].bytes.size()) return a[i].call + ": another number of them";
    const auto at = std::mismatch(a[i].bytes.begin(), a[i].bytes.end(), b[i].bytes.begin());
    const auto offset = static_cast<size_t>(at.first - a[i].bytes.begin());
    return a[i].call + ": record " + std::to_string(offset / a[i].record_size) + " differs";
  }
  return "";
}

size_t hit_count(const std::vector<NamedAnswers>& answers) {
  size_t count = 0;
  for (const NamedAnswers& answer : answers) {
    if (answer.call != "any hits") continue;
    for (const unsigned char byte : answer.bytes) count += byte;
  }
  return count;
}

}  // namespace kiwami_tests
