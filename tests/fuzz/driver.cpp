// SPDX-License-Identifier: Apache-2.0
// Runs a target without libFuzzer: on files, or on its seeds and on random changes of them. Without
// feedback from the code it finds less, but every compiler builds it.
//
//   TARGET [FILE...]        KIWAMI_SEED, KIWAMI_TEST_RAYS and KIWAMI_TEST_SCALE as for other tests
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <iterator>

#include "fuzz/fuzz.h"
#include "support/environment.h"
#include "support/random.h"

namespace kiwami_fuzz {
namespace {

using kiwami_tests::Random;

constexpr uint64_t kShortRuns = KIWAMI_FUZZ_RUNS;
constexpr size_t kGreatestSize = 1 << 16;

void overwrite(Bytes& bytes, Random& random) {
  constexpr uint64_t kNumbers[] = {0,          1,          0x7F,       0x80,       0xFF,
                                   0x7FFF,     0xFFFF,     0x7FFFFFFF, 1u << 31,   0xFFFFFFFF,
                                   0x7FC00000, 0x7F800000, 0xFF800000, 0x5D800000, ~uint64_t{0}};
  const uint64_t number = kNumbers[random.below(std::size(kNumbers))];
  const size_t size = std::min(bytes.size(), size_t{1} << random.below(4));
  const size_t at = random.below(static_cast<uint32_t>(bytes.size() - size + 1));
  std::memcpy(bytes.data() + at, &number, size);
}

/// A run of the bytes, or of another seed, goes to another place.
void copy_run(Bytes& bytes, const Bytes& from, Random& random) {
  if (from.empty()) return;
  const size_t begin = random.below(static_cast<uint32_t>(from.size()));
  const size_t size = std::min<size_t>(1 + random.below(64), from.size() - begin);
  const Bytes run(from.begin() + static_cast<std::ptrdiff_t>(begin),
                  from.begin() + static_cast<std::ptrdiff_t>(begin + size));
  const size_t at = random.below(static_cast<uint32_t>(bytes.size() + 1));
  if (random.one_in(2) && bytes.size() + size <= kGreatestSize) {
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(at), run.begin(), run.end());
  } else {
    const size_t part = std::min(size, bytes.size() - at);
    std::copy_n(run.begin(), part, bytes.begin() + static_cast<std::ptrdiff_t>(at));
  }
}

void change(Bytes& bytes, const std::vector<Bytes>& seeds, Random& random) {
  if (bytes.empty()) bytes.push_back(0);
  const size_t at = random.below(static_cast<uint32_t>(bytes.size()));
  switch (random.below(6)) {
    case 0:
      bytes[at] = static_cast<unsigned char>(bytes[at] ^ 1u << random.below(8));
      break;
    case 1:
      bytes[at] = static_cast<unsigned char>(random.bits());
      break;
    case 2:
      overwrite(bytes, random);
      break;
    case 3:
      copy_run(bytes, bytes, random);
      break;
    case 4:
      copy_run(bytes, seeds[random.below(static_cast<uint32_t>(seeds.size()))], random);
      break;
    default:
      bytes.resize(random.one_in(4) ? at : bytes.size() - std::min<size_t>(bytes.size() - at, 8));
      break;
  }
}

void run(const Bytes& bytes) {
  // Of exactly this size, so that a sanitizer sees every byte that is read beyond.
  const Bytes exact(bytes);
  LLVMFuzzerTestOneInput(exact.data(), exact.size());
}

int run_files(int count, char** paths) {
  for (int i = 0; i < count; ++i) {
    std::ifstream file(paths[i], std::ios::binary);
    if (!file) {
      std::fprintf(stderr, "cannot read '%s'\n", paths[i]);
      return 2;
    }
    run(Bytes(std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()));
  }
  return 0;
}

int run_changed_seeds() {
  const uint64_t runs = kiwami_tests::ray_budget(kShortRuns);
  const std::vector<Bytes> seeds = make_seeds();
  std::printf("seed %llu, %zu seeds, %llu runs\n",
              static_cast<unsigned long long>(kiwami_tests::seed()), seeds.size(),
              static_cast<unsigned long long>(runs));
  std::fflush(stdout);
  for (const Bytes& seed : seeds) run(seed);
  for (uint64_t i = 0; i < runs; ++i) {
    Random random(kiwami_tests::seed(), i);
    Bytes bytes = seeds[random.below(static_cast<uint32_t>(seeds.size()))];
    for (uint32_t changes = 1 + random.below(8); changes != 0; --changes) {
      change(bytes, seeds, random);
    }
    run(bytes);
  }
  return 0;
}

}  // namespace
}  // namespace kiwami_fuzz

extern "C" int LLVMFuzzerInitialize(int* argc, char*** argv);

int main(int argc, char** argv) {
  LLVMFuzzerInitialize(&argc, &argv);
  return argc > 1 ? kiwami_fuzz::run_files(argc - 1, argv + 1) : kiwami_fuzz::run_changed_seeds();
}
