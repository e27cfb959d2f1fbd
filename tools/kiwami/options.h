// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include "measure/library.h"
#include "scene/vector.h"

namespace kiwami::tools {

/// A command line that cannot be obeyed: one sentence without a full stop.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// The methods of a build, by name.
struct PipelineOptions {
  std::string quality = "balanced";
  std::string builder;      ///< empty: that of the quality
  std::string optimizers;   ///< between commas; empty: those of the quality; none: none
  std::string contraction;  ///< empty: that of the quality
  bool merge_leaves = true;
  std::string layout = "fast";

  BuildOptions build_options(uint32_t bvh_width) const;
};

/// Adds --quality, --builder, --optimize, --contract, --merge-leaves and --layout.
void add_pipeline_options(CLI::App& command, PipelineOptions& options);

/// The build of "BUILDER[+OPTIMIZER]...[,CONTRACTION][,merged|unmerged][,fast|compact]", spaces
/// apart, as pipeline_name writes it; `option` is named by the error.
BuildOptions parse_pipeline(const std::string& option, const std::string& text, uint32_t bvh_width);

/// Which kernels trace, and how.
struct TraceOptions {
  std::string isa = "auto";
  uint32_t bvh_width = 0;
  uint32_t threads = 0;

  Device make_device() const { return Device(isa_of_name(isa), threads); }
};

/// Adds --isa, --bvh-width and --threads.
void add_trace_options(CLI::App& command, TraceOptions& options);

/// Adds --instanced: whether the instances of a scene stay instances.
void add_instanced_option(CLI::App& command, bool& instanced);

/// Adds --motion: how the scene moves; see scene/motion.h.
void add_motion_option(CLI::App& command, std::string& motion);

/// Accept a whole number, or a finite number, within bounds; a sentence otherwise.
CLI::Validator whole_number(uint64_t lowest, uint64_t highest);
CLI::Validator finite_number(double lowest, double highest);

/// "1,2.5,-3" as a vector of finite numbers; `option` is named by the error.
Vec3 parse_vector(const std::string& option, const std::string& text);

/// The words between the commas, or other separators; `option` is named when one is empty.
std::vector<std::string> split_words(const std::string& option, const std::string& text,
                                     char separator = ',');

/// The same, where `option` is also named when a word comes twice.
std::vector<std::string> split_different_words(const std::string& option, const std::string& text);

/// The same, where each is one of the known ones.
std::vector<std::string> split_known_words(const std::string& option, const std::string& text,
                                           const std::vector<std::string>& known);

/// "a, b, c".
std::string joined_words(const std::vector<std::string>& words);

/// "640x480".
struct Size {
  uint32_t width;
  uint32_t height;
};
Size parse_size(const std::string& option, const std::string& text);

/// "1,234,567".
std::string grouped(uint64_t number);

/// ", 3 geometries that are shapes or move", of those that a loaded scene leaves out; "" for none.
std::string left_out_text(const SceneFile& file);

/// As printf, into a string.
std::string format(const char* pattern, ...) __attribute__((format(printf, 1, 2)));

}  // namespace kiwami::tools
