// SPDX-License-Identifier: Apache-2.0
#include "kiwami/options.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <iterator>
#include <optional>

namespace kiwami::tools {
namespace {

constexpr uint32_t kMaxPictureSide = 16384;
/// By KIWAMI_QUALITY_*.
constexpr const char* kQualityNames[] = {"balanced", "fast", "best"};

/// The whole text as a number, or nothing.
template <typename T>
std::optional<T> parse_number(std::string_view text) {
  T number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

}  // namespace

CLI::Validator whole_number(uint64_t lowest, uint64_t highest) {
  const auto check = [=](std::string& text) -> std::string {
    const std::optional<uint64_t> number = parse_number<uint64_t>(text);
    if (number && *number >= lowest && *number <= highest) return {};
    return "it is '" + text + "', expected a whole number of " + std::to_string(lowest) + " to " +
           std::to_string(highest);
  };
  return CLI::Validator(check, std::to_string(lowest) + " to " + std::to_string(highest));
}

CLI::Validator finite_number(double lowest, double highest) {
  const std::string bounds = format("%g to %g", lowest, highest);
  const auto check = [=](std::string& text) -> std::string {
    const std::optional<double> number = parse_number<double>(text);
    // Written so that NaN is refused.
    if (number && *number >= lowest && *number <= highest) return {};
    return "it is '" + text + "', expected a number of " + bounds;
  };
  return CLI::Validator(check, bounds);
}

void add_trace_options(CLI::App& command, TraceOptions& options) {
  const auto check_isa = [](std::string& text) -> std::string {
    for (const char* name : {"auto", "scalar", "sse", "avx2", "avx512"}) {
      if (text == name) return {};
    }
    return "it is '" + text + "', expected auto, scalar, sse, avx2 or avx512";
  };
  command.add_option("--isa", options.isa, "Instruction set: auto, scalar, sse, avx2 or avx512")
      ->check(CLI::Validator(check_isa, ""))
      ->capture_default_str();
  const auto check_width = [](std::string& text) -> std::string {
    if (text == "0" || text == "4" || text == "8" || text == "16") return {};
    return "it is '" + text + "', expected 4, 8, 16, or 0 for the device's default";
  };
  command
      .add_option("--bvh-width", options.bvh_width,
                  "Children a node: 4, 8, 16; 0: the default of the device")
      ->check(CLI::Validator(check_width, ""))
      ->capture_default_str();
  command.add_option("--threads", options.threads, "Threads; 0: one per processor")
      ->check(whole_number(0, 1024))
      ->capture_default_str();
}

void add_instanced_option(CLI::App& command, bool& instanced) {
  command.add_flag("--instanced", instanced,
                   "A scene with instances stays one, with a tree for each mesh and one over the "
                   "instances; by default it is flattened to triangles");
}

void add_motion_option(CLI::App& command, std::string& motion) {
  command.add_option("--motion", motion,
                     "Sets the scene in motion: meshes (a wave moves their vertices), instances "
                     "(each turns and moves; with --instanced), or the file of a second keyframe");
}

BuildOptions PipelineOptions::build_options(uint32_t bvh_width) const {
  const auto number = std::find(std::begin(kQualityNames), std::end(kQualityNames), quality);
  BuildOptions options =
      build_options_of(static_cast<uint32_t>(number - std::begin(kQualityNames)));
  options.bvh_width = bvh_width;
  options.merge_leaves = merge_leaves;
  options.layout = layout == "compact" ? KIWAMI_LAYOUT_COMPACT : KIWAMI_LAYOUT_FAST;
  if (!builder.empty()) options.builder = method_of_name(KIWAMI_STAGE_BUILDER, builder);
  if (!contraction.empty()) {
    options.contraction = method_of_name(KIWAMI_STAGE_CONTRACTION, contraction);
  }
  if (optimizers.empty()) return options;
  options.optimizers.clear();
  if (optimizers == "none") return options;
  for (const std::string& word : split_words("--optimize", optimizers)) {
    options.optimizers.push_back(method_of_name(KIWAMI_STAGE_OPTIMIZER, word));
  }
  return options;
}

void add_pipeline_options(CLI::App& command, PipelineOptions& options) {
  const auto check_quality = [](std::string& text) -> std::string {
    const bool is_known = std::find(std::begin(kQualityNames), std::end(kQualityNames), text) !=
                          std::end(kQualityNames);
    return is_known ? "" : "it is '" + text + "', expected balanced, fast or best";
  };
  const auto list = [](uint32_t stage) {
    std::string text;
    for (const std::string& name : method_names(stage)) text += (text.empty() ? "" : ", ") + name;
    return text;
  };
  command
      .add_option("--quality", options.quality,
                  "Which methods build the tree, but for those that the next options name")
      ->check(CLI::Validator(check_quality, ""))
      ->capture_default_str();
  command.add_option("--builder", options.builder,
                     "How the binary tree is made: " + list(KIWAMI_STAGE_BUILDER));
  command.add_option(
      "--optimize", options.optimizers,
      "What improves it, between commas, in this order: none, or " + list(KIWAMI_STAGE_OPTIMIZER));
  command.add_option("--contract", options.contraction,
                     "How it becomes wide: " + list(KIWAMI_STAGE_CONTRACTION));
  command.add_flag("--merge-leaves,!--no-merge-leaves", options.merge_leaves,
                   "Bottom nodes and leaf blocks are shared by masks (the default)");
  const auto check_layout = [](std::string& text) -> std::string {
    if (text == "fast" || text == "compact") return {};
    return "it is '" + text + "', expected fast or compact";
  };
  command
      .add_option("--layout", options.layout,
                  "What leaves hold: fast: triangles; compact: their numbers alone, rays read the "
                  "meshes")
      ->check(CLI::Validator(check_layout, ""))
      ->capture_default_str();
}

BuildOptions parse_pipeline(const std::string& option, const std::string& text,
                            uint32_t bvh_width) {
  std::string dense = text;
  std::erase(dense, ' ');
  const std::vector<std::string> parts = split_words(option, dense);
  const std::vector<std::string> methods = split_words(option, parts[0], '+');
  PipelineOptions pipeline;
  pipeline.builder = methods[0];
  pipeline.optimizers = methods.size() == 1 ? "none" : "";
  for (size_t i = 1; i < methods.size(); ++i) {
    pipeline.optimizers += (i > 1 ? "," : "") + methods[i];
  }
  for (size_t i = 1; i < parts.size(); ++i) {
    if (parts[i] == "merged" || parts[i] == "unmerged") {
      pipeline.merge_leaves = parts[i] == "merged";
    } else if (parts[i] == "fast" || parts[i] == "compact") {
      pipeline.layout = parts[i];
    } else {
      pipeline.contraction = parts[i];
    }
  }
  try {
    return pipeline.build_options(bvh_width);
  } catch (const LibraryError& error) {
    throw UsageError(option + " is '" + text + "': " + error.what());
  }
}

std::vector<std::string> split_words(const std::string& option, const std::string& text,
                                     char separator) {
  std::vector<std::string> words;
  for (size_t start = 0; start <= text.size();) {
    const size_t end = std::min(text.find(separator, start), text.size());
    words.push_back(text.substr(start, end - start));
    if (words.back().empty()) {
      throw UsageError(format("%s is '%s', expected words between %s", option.c_str(), text.c_str(),
                              separator == ',' ? "commas" : "plus signs"));
    }
    start = end + 1;
  }
  return words;
}

Vec3 parse_vector(const std::string& option, const std::string& text) {
  float numbers[3];
  std::string_view rest = text;
  for (int i = 0; i < 3; ++i) {
    const size_t end = i < 2 ? rest.find(',') : rest.size();
    const std::optional<float> number = parse_number<float>(rest.substr(0, end));
    if (end == std::string_view::npos || !number || !(std::abs(*number) <= KIWAMI_MAX_COORDINATE)) {
      throw UsageError(option + " is '" + text +
                       "', expected three numbers within 2^60 as in 1,2.5,-3");
    }
    numbers[i] = *number;
    if (i < 2) rest.remove_prefix(end + 1);
  }
  return {numbers[0], numbers[1], numbers[2]};
}

std::vector<std::string> split_different_words(const std::string& option, const std::string& text) {
  std::vector<std::string> words = split_words(option, text);
  for (const std::string& word : words) {
    if (std::count(words.begin(), words.end(), word) == 1) continue;
    throw UsageError(format("%s is '%s', expected different words between commas", option.c_str(),
                            text.c_str()));
  }
  return words;
}

std::vector<std::string> split_known_words(const std::string& option, const std::string& text,
                                           const std::vector<std::string>& known) {
  std::vector<std::string> words = split_different_words(option, text);
  for (const std::string& word : words) {
    if (std::find(known.begin(), known.end(), word) != known.end()) continue;
    throw UsageError(option + " has '" + word + "', expected some of " + joined_words(known));
  }
  return words;
}

std::string joined_words(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ", ") + word;
  return text;
}

Size parse_size(const std::string& option, const std::string& text) {
  const size_t cross = text.find('x');
  const std::string_view whole = text;
  const auto width = parse_number<uint32_t>(whole.substr(0, cross));
  const auto height =
      cross == std::string::npos ? std::nullopt : parse_number<uint32_t>(whole.substr(cross + 1));
  if (!width || !height || *width < 1 || *height < 1 || *width > kMaxPictureSide ||
      *height > kMaxPictureSide) {
    throw UsageError(option + " is '" + text + "', expected WIDTHxHEIGHT, each 1 to " +
                     std::to_string(kMaxPictureSide));
  }
  return {*width, *height};
}

std::string grouped(uint64_t number) {
  const std::string digits = std::to_string(number);
  std::string text;
  for (size_t i = 0; i < digits.size(); ++i) {
    if (i > 0 && (digits.size() - i) % 3 == 0) text += ',';
    text += digits[i];
  }
  return text;
}

std::string left_out_text(const SceneFile& file) {
  if (file.left_out_count == 0) return "";
  return ", " + grouped(file.left_out_count) + " geometries that are shapes or move";
}

std::string format(const char* pattern, ...) {
  va_list arguments;
  va_start(arguments, pattern);
  va_list copy;
  va_copy(copy, arguments);
  std::string text(static_cast<size_t>(std::vsnprintf(nullptr, 0, pattern, copy)), '\0');
  va_end(copy);
  std::vsnprintf(text.data(), text.size() + 1, pattern, arguments);
  va_end(arguments);
  return text;
}

}  // namespace kiwami::tools
