// SPDX-License-Identifier: Apache-2.0
// Under libFuzzer: writes the seeds to the folder that KIWAMI_FUZZ_CORPUS names, before it is read.
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>

#include "fuzz/fuzz.h"

namespace kiwami_fuzz {

void fail(const char* why) {
  std::fprintf(stderr, "%s\n", why);
  std::abort();
}

namespace {

void write_seeds(const std::string& folder) {
  int number = 0;
  for (const Bytes& seed : make_seeds()) {
    std::ofstream file(folder + "/seed-" + std::to_string(number++), std::ios::binary);
    file.write(reinterpret_cast<const char*>(seed.data()),
               static_cast<std::streamsize>(seed.size()));
  }
}

}  // namespace
}  // namespace kiwami_fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);
extern "C" int LLVMFuzzerInitialize(int*, char***) {
  if (const char* folder = std::getenv("KIWAMI_FUZZ_CORPUS")) kiwami_fuzz::write_seeds(folder);
  return 0;
}
