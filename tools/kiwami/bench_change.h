// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "kiwami/bench.h"

namespace kiwami::tools {

/// What it costs to follow a scene whose vertices all move.
struct ChangeRow {
  BenchCase of;
  double refit_milliseconds;
  double build_milliseconds;
  double sah;                     ///< of the built tree
  double refitted_sah;            ///< after the last move
  std::optional<PeerBuild> peer;  ///< its refits
  std::string wrong;              ///< what is wrong with the answers, or ""
};

/// Moves all vertices of a scene round by round and refits it, in turn with Embree: one row a
/// number of threads. The answers are compared with those of a scene built anew.
std::vector<ChangeRow> run_change(const std::string& scene, const BenchSettings& settings);

/// What it costs to commit a scene of many objects when one has moved.
struct EditRow {
  BenchCase of;
  uint32_t objects;
  double edit_milliseconds;
  double build_milliseconds;  ///< of all objects
};

/// Puts so many copies of a scene side by side, a tree for each, and moves one of them round by
/// round: one row a number of threads.
std::vector<EditRow> run_edit(const std::string& scene, uint32_t objects,
                              const BenchSettings& settings);

nlohmann::ordered_json to_json(const EditRow& row);
void print_row(const EditRow& row);

nlohmann::ordered_json to_json(const ChangeRow& row, const std::string& peer);
void print_row(const ChangeRow& row, const std::string& peer);

}  // namespace kiwami::tools
