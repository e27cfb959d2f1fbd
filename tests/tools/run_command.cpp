// SPDX-License-Identifier: Apache-2.0
#include "run_command.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace kiwami_tests {
namespace {

namespace fs = std::filesystem;

constexpr int kCannotRun = 127;

[[noreturn]] void run_child(const std::vector<std::string>& arguments, const std::string& output,
                            const std::string& errors) {
  const int out = open(output.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  const int err = open(errors.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (out < 0 || err < 0 || dup2(out, STDOUT_FILENO) < 0 || dup2(err, STDERR_FILENO) < 0) {
    _exit(kCannotRun);
  }
  std::vector<std::string> words = {KIWAMI_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  execv(KIWAMI_COMMAND, pointers.data());
  _exit(kCannotRun);
}

}  // namespace

CommandResult run_command(const std::vector<std::string>& arguments) {
  const TemporaryFolder folder;
  const std::string output = folder / "output";
  const std::string errors = folder / "errors";
  const pid_t child = fork();
  if (child < 0) throw std::runtime_error("cannot fork");
  if (child == 0) run_child(arguments, output, errors);
  int status = 0;
  if (waitpid(child, &status, 0) != child) throw std::runtime_error("cannot wait for the command");
  const int exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  return {exit_code, read_bytes(output), read_bytes(errors)};
}

std::string complaint_about_failure(const CommandResult& result) {
  const std::string& errors = result.errors;
  if (result.exit_code != 2) {
    return "exit code " + std::to_string(result.exit_code) + ", stderr: " + errors;
  }
  if (!errors.starts_with("kiwami: ") || errors.size() < 20 || errors.back() != '\n' ||
      errors.find('\n') != errors.size() - 1) {
    return "stderr is not one sentence: " + errors;
  }
  return "";
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (fs::temp_directory_path() / "kiwami-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw std::runtime_error("cannot make a folder");
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code error;
  fs::remove_all(path_, error);
}

std::string TemporaryFolder::write(const std::string& name, const std::string& bytes) const {
  std::ofstream file(path_ / name, std::ios::binary);
  file << bytes;
  return (path_ / name).string();
}

std::string read_bytes(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream bytes;
  bytes << file.rdbuf();
  return bytes.str();
}

std::string shared_scene(const std::string& name) {
  const char* variable = std::getenv("KIWAMI_SCENES");
  const fs::path folder = variable != nullptr && *variable != '\0'
                              ? fs::path(variable)
                              : fs::path(KIWAMI_SOURCE_DIR) / ".." / "shared" / "scenes";
  return fs::exists(folder / name) ? (folder / name).string() : "";
}

}  // namespace kiwami_tests
