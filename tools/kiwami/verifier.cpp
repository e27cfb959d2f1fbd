// SPDX-License-Identifier: Apache-2.0
#include "kiwami/verifier.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "kiwami/options.h"

namespace kiwami::tools {
namespace {

/// A picture of about this many rays, its shape 4 to 3.
Camera camera_for(const SceneFile& scene, const Box& box, size_t rays) {
  const auto height =
      static_cast<uint32_t>(std::max(1.0, std::sqrt(static_cast<double>(rays) * 0.75)));
  const uint32_t width = std::max(1u, height * 4 / 3);
  const float aspect = static_cast<float>(width) / static_cast<float>(height);
  return Camera(default_view(scene, box, aspect), width, height);
}

std::vector<RaySet> make_ray_sets(const SceneFile& scene, const BuiltScene& built, size_t count,
                                  uint64_t seed) {
  const Box box = bounds_of(built.info());
  std::vector<RaySet> sets;
  sets.push_back(primary_rays(camera_for(scene, box, count)));
  sets.push_back(bounce_rays(built, sets.front().rays, count, seed));
  sets.push_back(random_rays(box, count, seed));
  // Through vertices, of which there may be none.
  if (scene.triangle_count() == 0) return sets;
  sets.push_back(axis_rays(scene, box, count, seed));
  sets.push_back(aimed_rays(scene, box, count, seed));
  return sets;
}

void spread_times(std::vector<RaySet>& sets, uint64_t seed) {
  Random random(seed, 6);
  for (RaySet& set : sets) {
    for (kiwami_ray& ray : set.rays) ray.time = random.uniform();
  }
}

void print_number(const char* name, float value) {
  std::printf("    %-12s %-16a %.9g\n", name, static_cast<double>(value),
              static_cast<double>(value));
}

void print_ray(const kiwami_ray& ray) {
  print_number("origin x", ray.origin_x);
  print_number("origin y", ray.origin_y);
  print_number("origin z", ray.origin_z);
  print_number("direction x", ray.direction_x);
  print_number("direction y", ray.direction_y);
  print_number("direction z", ray.direction_z);
  print_number("tmin", ray.tmin);
  print_number("tmax", ray.tmax);
  print_number("time", ray.time);
  std::printf("    mask 0x%08x, flags %u\n", ray.mask, ray.flags);
}

void print_hit(const std::string& who, const kiwami_hit& hit) {
  std::printf("  %s:%s\n", who.c_str(), is_hit(hit) ? "" : " a miss");
  print_number("t", hit.t);
  print_number("u", hit.u);
  print_number("v", hit.v);
  print_number("normal x", hit.normal_x);
  print_number("normal y", hit.normal_y);
  print_number("normal z", hit.normal_z);
  std::printf("    primitive %u, geometry %u, instance %u\n", hit.primitive_id, hit.geometry_id,
              hit.instance_id);
}

void print_difference(const std::string& what, const RaySet& set, size_t index) {
  std::printf("\ndifference: %s of ray %zu of the set '%s'\n", what.c_str(), index,
              set.name.c_str());
  print_ray(set.rays[index]);
}

std::string name_of(const Contender& contender) {
  return format("%s, %u wide, %s, %u threads", kiwami_isa_name(contender.isa), contender.bvh_width,
                contender.merge_leaves ? "merged" : "unmerged", contender.threads);
}

constexpr const char* kReferenceName = "scalar, 4 wide, merged, 1 thread";

}  // namespace

Verifier::Verifier(const SceneFile& world, const SceneFile& built, const BuildOptions& build,
                   const std::string& path, size_t rays_per_set, uint64_t seed)
    : world_(world),
      built_(built),
      build_(build),
      path_(path),
      device_(KIWAMI_ISA_SCALAR, 1),
      reference_(make(device_, {4, true})),
      sets_(make_ray_sets(world, reference_, rays_per_set, seed)) {
  if (!path_.empty()) spread_times(sets_, seed);
  expected_ = trace_answers(reference_, sets_);
}

Verifier::Verifier(const SceneFile& world, const SceneFile& built, const BuildOptions& build,
                   size_t rays_per_set, uint64_t seed)
    : Verifier(world, built, build, "", rays_per_set, seed) {}

Verifier::Verifier(const SceneFile& world, const SceneFile& file, const std::string& path,
                   size_t rays_per_set, uint64_t seed)
    : Verifier(world, file, {}, path, rays_per_set, seed) {}

BuiltScene Verifier::make(const Device& device, const BuildOptions& build) const {
  if (path_.empty()) return BuiltScene(device, built_, build);
  return BuiltScene(device, path_, KIWAMI_LOAD_MAP, &built_, build.bvh_width);
}

bool Verifier::run() {
  for (const RaySet& set : sets_) {
    std::printf("%-14s %s rays\n", set.name.c_str(), grouped(set.rays.size()).c_str());
  }
  if (reference_.info().skipped_count > 0) {
    std::printf("note: %s triangles are skipped: a vertex is NaN, infinite or beyond 2^60\n",
                grouped(reference_.info().skipped_count).c_str());
  }
  std::printf("\nbit for bit against %s\n", kReferenceName);
  std::printf("%-8s %6s %9s %8s %10s %12s  %s\n", "ISA", "width", "kernels", "merged", "threads",
              "build ms", "result");
  if (!compare(expected_, kReferenceName)) return false;
  for (const uint32_t isa : available_isas()) {
    for (const uint32_t width : {4u, 8u, 16u}) {
      for (const bool merge : {true, false}) {
        if (!merge && !path_.empty()) continue;
        for (const uint32_t threads : {1u, 2u}) {
          if (!run_contender({isa, width, merge, threads})) return false;
        }
      }
    }
  }
  return compare_with_embree();
}

bool Verifier::run_contender(const Contender& contender) {
  const Device device(contender.isa, contender.threads);
  BuildOptions build = build_;
  build.bvh_width = contender.bvh_width;
  build.merge_leaves = contender.merge_leaves;
  const BuiltScene scene = make(device, build);
  const bool native = (device.info().native_widths & (1u << contender.bvh_width)) != 0;
  std::printf("%-8s %6u %9s %8s %10u %12.1f  ", kiwami_isa_name(contender.isa), contender.bvh_width,
              native ? "native" : "scalar",
              !path_.empty()           ? "as saved"
              : contender.merge_leaves ? "yes"
                                       : "no",
              contender.threads, scene.info().build_seconds * 1e3);
  std::fflush(stdout);
  if (!compare(trace_answers(scene, sets_), name_of(contender))) return false;
  std::printf("equal\n");
  return true;
}

bool Verifier::compare(const Answers& answers, const std::string& name) const {
  const std::optional<Difference> difference = first_difference(expected_, answers);
  if (!difference) return true;
  const auto [set, ray, of_any_hit] = *difference;
  print_difference(of_any_hit ? "any hit" : "closest hit", sets_[set], ray);
  print_hit(kReferenceName, expected_.hits[set][ray]);
  print_hit(name, answers.hits[set][ray]);
  if (of_any_hit) std::printf("  any hit says %u\n", answers.occluded[set][ray]);
  return false;
}

bool Verifier::compare_with_embree() const {
  if (!path_.empty()) {
    std::printf("\nnot compared with Embree: the scene holds more than triangles at rest\n");
    return true;
  }
  const std::unique_ptr<EmbreeTracer> embree = EmbreeTracer::create(world_, true);
  if (!embree) {
    std::printf("\nnot compared with Embree: these tools were built without it\n");
    return true;
  }
  std::array<uint64_t, kAgreementCount> counts{};
  for (size_t s = 0; s < sets_.size(); ++s) {
    std::vector<kiwami_hit> hits(sets_[s].rays.size());
    embree->closest_hits(sets_[s].rays, hits);
    for (size_t i = 0; i < hits.size(); ++i) {
      const kiwami_ray& ray = sets_[s].rays[i];
      // Embree has no culling by ray.
      if (ray.flags != 0) continue;
      const kiwami_hit& own = expected_.hits[s][i];
      const Agreement agreement = compare_hits(world_, ray, own, hits[i]);
      ++counts[static_cast<size_t>(agreement)];
      if (agreement == Agreement::kWrong) {
        print_difference("closest hit (Embree and double precision)", sets_[s], i);
        print_hit("Kiwami", own);
        print_hit("Embree", hits[i]);
        return false;
      }
    }
  }
  std::printf("\nagainst Embree %s (robust), decided by double precision where they differ\n",
              embree_version());
  for (size_t i = 0; i < counts.size(); ++i) {
    std::printf("%12s  %s\n", grouped(counts[i]).c_str(),
                agreement_name(static_cast<Agreement>(i)));
  }
  return true;
}

}  // namespace kiwami::tools
