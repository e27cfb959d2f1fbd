// SPDX-License-Identifier: Apache-2.0
// The `kiwami` command. It exits with 0, with 2 and one sentence on stderr, or, of `verify` alone,
// with 1 when two answers differ.
#include <cstdio>
#include <exception>
#include <new>
#include <string>

#include "kiwami/commands.h"

namespace {

constexpr int kFailure = 2;

int fail(std::string sentence) {
  sentence = sentence.substr(0, sentence.find('\n'));
  std::fprintf(stderr, "kiwami: %s\n", sentence.c_str());
  return kFailure;
}

int run(int argc, char** argv) {
  int exit_code = 0;
  CLI::App app("Acceleration structures for ray tracing on CPUs", "kiwami");
  app.require_subcommand(1);
  app.set_help_all_flag("--help-all", "Print the help of all commands and exit");
  kiwami::tools::add_info_command(app, exit_code);
  kiwami::tools::add_render_command(app, exit_code);
  kiwami::tools::add_verify_command(app, exit_code);
  kiwami::tools::add_demo_command(app, exit_code);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& request) {
    return app.exit(request);  // prints the help that was asked for
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
