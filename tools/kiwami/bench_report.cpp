// SPDX-License-Identifier: Apache-2.0
#include "kiwami/bench_report.h"

#include <cmath>
#include <cstdio>

#include "kiwami/options.h"

namespace kiwami::tools {
namespace {

void put_case(nlohmann::ordered_json& json, const BenchCase& of) {
  json["threads"] = of.threads;
  json["isa"] = of.isa;
  json["width"] = of.width;
}

const char* query_name(bool any_hit) { return any_hit ? "any hit" : "closest hit"; }

}  // namespace

nlohmann::ordered_json to_json(const BuildRow& row, const std::string& peer) {
  nlohmann::ordered_json json;
  json["scene"] = row.of.scene;
  json["triangles"] = row.of.triangles;
  put_case(json, row.of);
  json["build_ms"] = row.milliseconds;
  if (row.peer) {
    json["peer"] = peer;
    json["peer_build_ms"] = row.peer->milliseconds;
  }
  json["bytes_per_triangle"] = row.bytes_per_triangle;
  json["peak_bytes_per_triangle"] = row.peak_bytes_per_triangle;
  json["sah"] = row.sah;
  json["epo"] = row.epo;
  if (row.peer) {
    json["build_ratio"] = row.peer->ratio;
    json["peer_bytes_per_triangle"] = row.peer->bytes_per_triangle;
  }
  return json;
}

nlohmann::ordered_json to_json(const TraceRow& row, const std::string& peer) {
  nlohmann::ordered_json json;
  json["scene"] = row.of.scene;
  json["triangles"] = row.of.triangles;
  json["rays"] = row.rays;
  json["api"] = bench_api_name(row.api);
  put_case(json, row.of);
  json["mrays"] = row.mrays;
  if (row.peer) {
    json["peer"] = peer;
    json["peer_mrays"] = row.peer->mrays;
    json["ratio"] = row.peer->ratio;
  }
  json["hits_hash"] = format("%016llx", static_cast<unsigned long long>(row.hits_hash));
  json["any_hit"] = row.any_hit;
  json["node_visits"] = row.visits.nodes;
  json["leaf_visits"] = row.visits.leaves;
  json["leaf_count_variability"] = row.visits.leaf_count_variability;
  if (row.peer) {
    json["peer_entrance"] = row.peer->entrance;
    json["peer_disagreements"] = row.peer->disagreements;
  }
  return json;
}

void print_row(const BuildRow& row, const std::string& peer) {
  std::printf("\n%s: %s triangles; %s, %u wide, %u thread%s\n", row.of.scene.c_str(),
              grouped(row.of.triangles).c_str(), row.of.isa.c_str(), row.of.width, row.of.threads,
              row.of.threads == 1 ? "" : "s");
  std::printf("  build %.1f ms", row.milliseconds);
  if (row.peer) {
    std::printf(" (%s %.1f ms, ratio %.2f)", peer.c_str(), row.peer->milliseconds, row.peer->ratio);
  }
  std::printf("; %.1f bytes per triangle, %.1f at the peak", row.bytes_per_triangle,
              row.peak_bytes_per_triangle);
  if (row.peer) std::printf(" (%s %.1f)", peer.c_str(), row.peer->bytes_per_triangle);
  std::printf("; SAH %.2f, EPO %.2f\n", row.sah, row.epo);
}

void print_row(const TraceRow& row) {
  std::printf("  %-6s %-15s %8.3f Mrays/s  visits %5.1f nodes %5.2f leaves (+-%5.2f)",
              bench_api_name(row.api), row.rays.c_str(), row.mrays, row.visits.nodes,
              row.visits.leaves, row.visits.leaf_count_variability);
  if (row.peer) {
    std::printf("  ratio %5.2f to %8.3f of %s", row.peer->ratio, row.peer->mrays,
                row.peer->entrance.c_str());
    if (row.peer->disagreements > 0) {
      std::printf(" (%s answers differ)", grouped(row.peer->disagreements).c_str());
    }
  }
  std::printf("\n");
  if (!row.wrong.empty()) std::printf("  WRONG: %s\n", row.wrong.c_str());
  std::fflush(stdout);
}

void RatioSummary::add(const TraceRow& row) {
  if (!row.peer) return;
  const std::string group = format("%s, %u thread%s", bench_api_name(row.api), row.of.threads,
                                   row.of.threads == 1 ? "" : "s");
  ratios_[group].push_back(row.peer->ratio);
  ratios_[group + ", " + query_name(row.any_hit)].push_back(row.peer->ratio);
}

void RatioSummary::print(const std::string& peer) const {
  if (ratios_.empty()) return;
  std::printf("\nGeometric means of the ratios to %s\n", peer.c_str());
  for (const auto& [group, ratios] : ratios_) {
    std::printf("  %-32s %5.2f of %zu\n", group.c_str(), geometric_mean(ratios), ratios.size());
  }
}

double geometric_mean(const std::vector<double>& values) {
  double sum = 0.0;
  for (const double value : values) sum += std::log(value);
  return std::exp(sum / static_cast<double>(values.size()));
}

}  // namespace kiwami::tools
