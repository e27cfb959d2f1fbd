// SPDX-License-Identifier: Apache-2.0
#include "kiwami/demo_table.h"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "kiwami/options.h"
#include "measure/contest.h"
#include "measure/library.h"
#include "measure/ray_sets.h"

namespace kiwami::tools {
namespace {

constexpr uint64_t kSeed = 1;
constexpr uint32_t kBuilds = 3;

/// A row and what is traced for it.
struct Entry {
  DemoRow row;
  std::unique_ptr<Device> device;
  std::unique_ptr<Tracer> tracer;
};

double per_triangle(uint64_t bytes, uint64_t triangles) {
  return static_cast<double>(bytes) / static_cast<double>(std::max<uint64_t>(triangles, 1));
}

Entry make_entry(const SceneFile& file, uint32_t isa, uint32_t width) {
  Entry entry;
  entry.device = std::make_unique<Device>(isa, 1);
  std::vector<double> seconds;
  std::unique_ptr<BuiltScene> scene;
  for (uint32_t i = 0; i < kBuilds; ++i) {
    scene.reset();
    BuildOptions build = build_options_of(KIWAMI_QUALITY_BALANCED);
    build.bvh_width = width;
    scene = std::make_unique<BuiltScene>(*entry.device, file, build);
    seconds.push_back(scene->info().build_seconds);
  }
  const kiwami_scene_info& info = scene->info();
  entry.row.name = kiwami_isa_name(isa);
  entry.row.bvh_width = width;
  entry.row.build_seconds = median(seconds);
  entry.row.bytes_per_triangle = per_triangle(info.total_bytes, info.triangle_count);
  entry.row.node_fill = info.node_fill;
  entry.row.leaf_fill = info.leaf_fill;
  entry.row.equal_bits = true;
  entry.tracer = std::move(scene);
  return entry;
}

std::optional<Entry> make_embree_entry(const SceneFile& file) {
  std::vector<double> seconds;
  std::unique_ptr<EmbreeTracer> tracer;
  for (uint32_t i = 0; i < kBuilds; ++i) {
    tracer.reset();
    tracer = EmbreeTracer::create(file, false);
    if (!tracer) return std::nullopt;
    seconds.push_back(tracer->build_seconds());
  }
  Entry entry;
  entry.row.name = std::string("Embree ") + embree_version();
  entry.row.build_seconds = median(seconds);
  entry.row.bytes_per_triangle = per_triangle(tracer->bytes(), file.triangle_count());
  entry.tracer = std::move(tracer);
  return entry;
}

/// Every ISA at the widths that it has kernels for; the first one is scalar, 4 wide.
std::vector<Entry> make_entries(const SceneFile& file) {
  std::vector<Entry> entries;
  for (const uint32_t isa : available_isas()) {
    const uint32_t widths = Device(isa, 1).info().native_widths;
    for (const uint32_t width : {4u, 8u, 16u}) {
      if ((widths & (1u << width)) != 0) entries.push_back(make_entry(file, isa, width));
    }
  }
  return entries;
}

/// Times all entries on the same rays. Each Kiwami run's hits are compared with the scalar ones.
void measure_rate(std::vector<Entry>& entries, const std::vector<kiwami_ray>& rays, uint32_t rounds,
                  double DemoRow::*rate) {
  if (rays.empty()) return;
  std::vector<kiwami_hit> hits(rays.size());
  entries.front().tracer->closest_hits(rays, hits);
  const uint64_t expected = hash_hits(hits);
  std::vector<std::function<void()>> contenders;
  for (Entry& entry : entries) {
    contenders.emplace_back([&] { entry.tracer->closest_hits(rays, hits); });
    contenders.back()();  // warms the caches, and touches each tree's memory
  }
  const std::vector<double> seconds = interleaved_medians(contenders, rounds, [&](size_t i) {
    if (hash_hits(hits) != expected) entries[i].row.equal_bits = false;
  });
  for (size_t i = 0; i < entries.size(); ++i) {
    entries[i].row.*rate = static_cast<double>(rays.size()) / seconds[i];
  }
}

void print_row(const DemoRow& row, const std::optional<DemoRow>& embree) {
  const bool is_embree = row.bvh_width == 0;
  const auto ratio = [&](double DemoRow::*rate) {
    if (is_embree || !embree || !(*embree.*rate > 0.0)) return std::string("-");
    return format("%.2f", row.*rate / (*embree.*rate));
  };
  const auto only_ours = [&](const std::string& text) { return is_embree ? "-" : text; };
  std::printf("%-14s %5s %9.1f %9.2f %11.2f %11.1f %9s %9s %6s %8s %11s\n", row.name.c_str(),
              only_ours(std::to_string(row.bvh_width)).c_str(), row.build_seconds * 1e3,
              row.primary_rate * 1e-6, row.incoherent_rate * 1e-6, row.bytes_per_triangle,
              only_ours(format("%.1f %%", row.node_fill * 100.0)).c_str(),
              only_ours(format("%.1f %%", row.leaf_fill * 100.0)).c_str(),
              only_ours(row.equal_bits ? "yes" : "NO").c_str(),
              ratio(&DemoRow::primary_rate).c_str(), ratio(&DemoRow::incoherent_rate).c_str());
}

nlohmann::ordered_json row_to_json(const DemoRow& row) {
  nlohmann::ordered_json json;
  json["name"] = row.name;
  json["build_ms"] = row.build_seconds * 1e3;
  json["primary_mrays_per_second"] = row.primary_rate * 1e-6;
  json["incoherent_mrays_per_second"] = row.incoherent_rate * 1e-6;
  json["bytes_per_triangle"] = row.bytes_per_triangle;
  if (row.bvh_width == 0) return json;
  json["bvh_width"] = row.bvh_width;
  json["node_fill"] = row.node_fill;
  json["leaf_fill"] = row.leaf_fill;
  json["bits_equal_to_scalar"] = row.equal_bits;
  return json;
}

}  // namespace

DemoTable measure_demo(const std::string& name, const SceneFile& file,
                       const DemoSettings& settings) {
  std::vector<Entry> entries = make_entries(file);
  const auto& scalar = static_cast<const BuiltScene&>(*entries.front().tracer);
  const kiwami_scene_info info = scalar.info();
  const float aspect = static_cast<float>(settings.width) / static_cast<float>(settings.height);
  const View view = default_view(file, bounds_of(info), aspect);
  const RaySet primary = primary_rays(Camera(view, settings.width, settings.height));
  const RaySet incoherent = bounce_rays(scalar, primary.rays, primary.rays.size(), kSeed);

  std::optional<Entry> embree = make_embree_entry(file);
  if (embree) entries.push_back(std::move(*embree));
  measure_rate(entries, primary.rays, settings.rounds, &DemoRow::primary_rate);
  measure_rate(entries, incoherent.rays, settings.rounds, &DemoRow::incoherent_rate);

  DemoTable table{
      name, info.triangle_count, info.skipped_count, primary.rays.size(), incoherent.rays.size(),
      {},   std::nullopt};
  if (embree) {
    table.embree = entries.back().row;
    entries.pop_back();
  }
  for (Entry& entry : entries) table.rows.push_back(entry.row);
  return table;
}

void print_demo(const DemoTable& table) {
  std::printf("\n%s: %s triangles%s; %s primary and %s incoherent rays, one thread\n",
              table.scene.c_str(), grouped(table.triangle_count).c_str(),
              table.skipped_count > 0
                  ? (" (" + grouped(table.skipped_count) + " skipped: NaN or out of range)").c_str()
                  : "",
              grouped(table.primary_count).c_str(), grouped(table.incoherent_count).c_str());
  std::printf("%-14s %5s %9s %9s %11s %11s %9s %9s %6s %20s\n", "", "", "", "primary", "incoherent",
              "bytes per", "node", "leaf", "bits", "ratio to Embree");
  std::printf("%-14s %5s %9s %9s %11s %11s %9s %9s %6s %8s %11s\n", "ISA", "width", "build ms",
              "Mrays/s", "Mrays/s", "triangle", "fill", "fill", "equal", "primary", "incoherent");
  for (const DemoRow& row : table.rows) print_row(row, table.embree);
  if (table.embree) print_row(*table.embree, table.embree);
}

nlohmann::ordered_json demo_to_json(const DemoTable& table) {
  nlohmann::ordered_json json;
  json["scene"] = table.scene;
  json["triangles"] = table.triangle_count;
  json["skipped_triangles"] = table.skipped_count;
  json["primary_rays"] = table.primary_count;
  json["incoherent_rays"] = table.incoherent_count;
  json["threads"] = 1;
  for (const DemoRow& row : table.rows) {
    nlohmann::ordered_json entry = row_to_json(row);
    if (table.embree) {
      entry["primary_ratio_to_embree"] = row.primary_rate / table.embree->primary_rate;
      if (table.embree->incoherent_rate > 0.0) {
        entry["incoherent_ratio_to_embree"] = row.incoherent_rate / table.embree->incoherent_rate;
      }
    }
    json["rows"].push_back(std::move(entry));
  }
  if (table.embree) json["embree"] = row_to_json(*table.embree);
  return json;
}

}  // namespace kiwami::tools
