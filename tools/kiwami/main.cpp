// SPDX-License-Identifier: Apache-2.0
// The `kiwami` command. It exits with 0, with 2 and one sentence on stderr, or, of `verify`,
// `demo` and `bench`, with 1 when two answers differ.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "kiwami/commands.h"
#include "kiwami/options.h"

namespace {

constexpr int kFailure = 2;

int fail(std::string sentence) {
  sentence = sentence.substr(0, sentence.find('\n'));
  std::fprintf(stderr, "kiwami: %s\n", sentence.c_str());
  return kFailure;
}

/// CLI11 says of an unknown command no more than that one is required.
void check_command_name(const CLI::App& app, int argc, char** argv) {
  const std::string expected =
      ", expected info, build, render, verify, demo, bench or inspect; see kiwami --help";
  if (argc < 2) throw kiwami::tools::UsageError("no command is given" + expected);
  const std::string name = argv[1];
  const auto commands =
      app.get_subcommands([&](const CLI::App* command) { return command->get_name() == name; });
  if (!name.starts_with("-") && commands.empty()) {
    throw kiwami::tools::UsageError("there is no command '" + name + "'" + expected);
  }
}

int run(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app("Acceleration structures for ray tracing on CPUs", "kiwami");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Print the help of all commands and exit");
  kiwami::tools::add_info_command(app, exit_code);
  kiwami::tools::add_build_command(app, exit_code);
  kiwami::tools::add_render_command(app, exit_code);
  kiwami::tools::add_verify_command(app, exit_code);
  kiwami::tools::add_demo_command(app, exit_code);
  kiwami::tools::add_bench_command(app, exit_code);
  kiwami::tools::add_inspect_command(app, exit_code);
  check_command_name(app, argc, argv);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    return app.exit(request);  // prints the help that was asked for
  } catch (const CLI::ArgumentMismatch& error) {
    return fail("an option lacks its value or has too many: " + std::string(error.what()));
  } catch (const CLI::ParseError& error) {
    return fail(error.what());
  }
  return exit_code;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run(argc, argv);
  } catch (const std::bad_alloc&) {
    return fail("there is not enough memory");
  } catch (const std::exception& error) {
    return fail(error.what());
  }
}
