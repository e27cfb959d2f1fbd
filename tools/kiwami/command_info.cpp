// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "kiwami/commands.h"
#include "kiwami/options.h"

namespace kiwami::tools {
namespace {

constexpr uint32_t kWidths[] = {4, 8, 16};

std::string cpu_name() {
  std::ifstream file("/proc/cpuinfo");
  std::string line;
  while (std::getline(file, line)) {
    const size_t colon = line.find(": ");
    if (colon == std::string::npos) continue;
    if (line.starts_with("model name") || line.starts_with("Model")) return line.substr(colon + 2);
  }
  return "unknown";
}

std::vector<std::string> isa_names(uint32_t bits) {
  std::vector<std::string> names;
  for (const uint32_t isa :
       {KIWAMI_ISA_SCALAR, KIWAMI_ISA_SSE, KIWAMI_ISA_AVX2, KIWAMI_ISA_AVX512}) {
    if ((bits & (1u << isa)) != 0) names.emplace_back(kiwami_isa_name(isa));
  }
  return names;
}

std::string version_text(uint32_t version) {
  return format("%u.%u.%u", version / 1000000, version / 1000 % 1000, version % 1000);
}

/// What both forms of the output say.
nlohmann::ordered_json collect() {
  const Device device;
  const kiwami_device_info& info = device.info();
  nlohmann::ordered_json report;
  report["version"] = version_text(kiwami_version());
  report["abi_version"] = kiwami_abi_version();
  report["compiler"] =
#if defined(__clang__)
      "clang " __clang_version__;
#else
      "gcc " __VERSION__;
#endif
  report["build_type"] = KIWAMI_BUILD_TYPE;
  report["tasking"] = KIWAMI_TASKING_NAME;
  report["embree"] = embree_version();
  report["cpu"] = cpu_name();
  report["isas_built"] = isa_names(info.isa_built);
  report["isas_available"] = isa_names(info.isa_available);
  report["default_isa"] = kiwami_isa_name(info.isa);
  report["default_bvh_width"] = info.default_bvh_width;
  report["threads"] = info.thread_count;
  for (const uint32_t isa : available_isas()) {
    std::vector<uint32_t> widths;
    const Device of_isa(isa, 1);
    for (const uint32_t width : kWidths) {
      if ((of_isa.info().native_widths & (1u << width)) != 0) widths.push_back(width);
    }
    report["native_widths"][kiwami_isa_name(isa)] = widths;
  }
  return report;
}

nlohmann::ordered_json collect_file(const std::string& path) {
  const Device device;
  const kiwami_file_info info = file_info_of(device, path);
  constexpr const char* kFits[] = {
      "fits", "fits, but its width has no kernels of this instruction set: scalar ones trace it",
      "does not fit: a newer version wrote it"};
  nlohmann::ordered_json report;
  report["kind"] = info.kind == KIWAMI_FILE_SCENE    ? "scene"
                   : info.kind == KIWAMI_FILE_LIGHTS ? "lights"
                                                     : "tree";
  report["fit"] = kFits[std::min<uint32_t>(info.fit, 2)];
  report["format_version"] = info.format_version;
  report["library_version"] = version_text(info.library_version);
  report["bvh_width"] = info.bvh_width;
  report["sections"] = info.section_count;
  report["bytes"] = info.file_bytes;
  report["triangles"] = info.triangle_count;
  report["nodes"] = info.node_count;
  return report;
}

void print_file(const nlohmann::ordered_json& report) {
  for (const auto& [key, value] : report.items()) {
    const std::string text =
        value.is_string() ? value.get<std::string>() : grouped(value.get<uint64_t>());
    std::printf("%-16s %s\n", key.c_str(), text.c_str());
  }
}

void print_text(const nlohmann::ordered_json& report) {
  const auto line = [](const char* name, const std::string& value) {
    std::printf("%-16s %s\n", name, value.c_str());
  };
  const auto text = [&](const char* key) { return report[key].get<std::string>(); };
  const auto words = [&](const char* key) {
    return joined_words(report[key].get<std::vector<std::string>>());
  };
  line("version", text("version") + ", ABI " + report["abi_version"].dump());
  line("build", text("compiler") + ", " + text("build_type") + ", tasking " + text("tasking"));
  line("embree", text("embree").empty() ? "built without" : text("embree"));
  line("cpu", text("cpu"));
  line("ISAs built", words("isas_built"));
  line("ISAs available", words("isas_available"));
  for (const auto& [isa, widths] : report["native_widths"].items()) {
    std::vector<std::string> numbers;
    for (const auto& width : widths) numbers.push_back(width.dump());
    line(("  " + isa).c_str(), "widths " + joined_words(numbers) + "; others on scalar kernels");
  }
  line("default", text("default_isa") + ", " + report["default_bvh_width"].dump() + " wide, " +
                      report["threads"].dump() + " threads");
}

}  // namespace

void add_info_command(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("info", "Say what this build and this machine can do");
  const auto as_json = std::make_shared<bool>(false);
  const auto path = std::make_shared<std::string>();
  command->add_option("FILE", *path, "A .kiwami file: say what it is instead, and whether it fits");
  command->add_flag("--json", *as_json, "Print JSON");
  command->callback([as_json, path, &exit_code] {
    const nlohmann::ordered_json report = path->empty() ? collect() : collect_file(*path);
    if (*as_json) {
      std::printf("%s\n", report.dump(2).c_str());
    } else if (!path->empty()) {
      print_file(report);
    } else {
      print_text(report);
    }
    exit_code = 0;
  });
}

}  // namespace kiwami::tools
