// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace kiwami_tests {

/// What a run of the `kiwami` command left.
struct CommandResult {
  int exit_code;  ///< minus the number of the signal that ended it
  std::string output;
  std::string errors;
};

/// Runs the command and waits for it.
CommandResult run_command(const std::vector<std::string>& arguments);

/// Whether the command failed as it promises: exit code 2, nothing but one sentence on stderr.
/// What is wrong otherwise, or "".
std::string complaint_about_failure(const CommandResult& result);

/// A new empty folder, removed with the object.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::string operator/(const std::string& name) const { return (path_ / name).string(); }
  /// Writes a file and returns its path.
  std::string write(const std::string& name, const std::string& bytes) const;

 private:
  std::filesystem::path path_;
};

/// The bytes of a file; "" when it cannot be read.
std::string read_bytes(const std::string& path);

/// A file of the shared scenes, or "" where they are absent.
std::string shared_scene(const std::string& name);

}  // namespace kiwami_tests
