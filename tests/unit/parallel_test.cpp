// SPDX-License-Identifier: Apache-2.0
// Parallel loops: each index once, exceptions carried back, nesting, the floating-point state.
#include "parallel/parallel.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cfenv>
#include <memory>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "core/error.h"

namespace kiwami {
namespace {

/// A runner of two threads, which split the indices in halves.
int32_t run_halves(void* status, size_t count, kiwami_parallel_task task, void* data) {
  std::thread upper([&] {
    for (size_t i = count / 2; i < count; ++i) task(data, i);
  });
  for (size_t i = 0; i < count / 2; ++i) task(data, i);
  upper.join();
  return *static_cast<int32_t*>(status);
}

/// By arithmetic, since fegetround reads the state of another unit on x86.
bool rounds_up() {
  volatile float one = 1.0f, little = 0x1p-40f;
  return one + little > 1.0f;
}

struct Kind {
  const char* name;
  unsigned thread_count;
  bool has_runner;
};

class ParallelTest : public testing::TestWithParam<Kind> {
 protected:
  int32_t status_ = 0;
  const Parallel parallel_{GetParam().thread_count, GetParam().has_runner ? run_halves : nullptr,
                           &status_, 2};
};

TEST_P(ParallelTest, EachIndexOnce) {
  for (size_t count : {0u, 1u, 2u, 3u, 1000u}) {
    const auto calls = std::make_unique<std::atomic<int>[]>(count + 1);
    parallel_.for_each(count, [&](size_t index) { ++calls[index]; });
    for (size_t i = 0; i < count; ++i) EXPECT_EQ(calls[i], 1) << i << " of " << count;
    EXPECT_EQ(calls[count], 0);
  }
}

TEST_P(ParallelTest, BlocksCoverTheRange) {
  for (size_t count : {0u, 1u, 9u, 10u, 11u, 1005u}) {
    std::vector<int> calls(count, 0);
    parallel_.for_blocks(count, 10, [&](size_t begin, size_t end) {
      EXPECT_LE(end - begin, 10u);
      for (size_t i = begin; i < end; ++i) ++calls[i];
    });
    EXPECT_EQ(calls, std::vector<int>(count, 1));
  }
}

TEST_P(ParallelTest, AnExceptionComesBackAsItWas) {
  const auto fail_at = [&](size_t failing) {
    parallel_.for_each(500, [&](size_t index) {
      if (index == failing) throw Error(KIWAMI_ERROR_TOO_LARGE, "index %zu", index);
    });
  };
  for (size_t failing : {0u, 250u, 499u}) {
    try {
      fail_at(failing);
      ADD_FAILURE() << "no exception of index " << failing;
    } catch (const Error& error) {
      EXPECT_EQ(error.result(), KIWAMI_ERROR_TOO_LARGE);
      EXPECT_EQ(std::string(error.what()), "index " + std::to_string(failing));
    }
  }
  EXPECT_NO_THROW(fail_at(500));
}

TEST_P(ParallelTest, ManyExceptionsAreOne) {
  EXPECT_THROW(parallel_.for_each(500, [](size_t) { throw std::runtime_error("each"); }),
               std::runtime_error);
}

TEST_P(ParallelTest, LoopsMayBeNested) {
  std::atomic<size_t> sum{0};
  parallel_.for_each(20, [&](size_t outer) {
    parallel_.for_each(20, [&](size_t inner) { sum += 20 * outer + inner; });
  });
  EXPECT_EQ(sum, size_t{399 * 400 / 2});
}

TEST_P(ParallelTest, BodiesRoundToNearestAndTheCallersModeStays) {
  std::fesetround(FE_UPWARD);
  std::atomic<int> others{0};
  parallel_.for_each(100, [&](size_t) { others += rounds_up(); });
  const bool is_restored = rounds_up();
  std::fesetround(FE_TONEAREST);
  EXPECT_EQ(others, 0);
  EXPECT_TRUE(is_restored);
}

TEST_P(ParallelTest, AFailingRunnerIsAnError) {
  if (!GetParam().has_runner) GTEST_SKIP() << "has no runner";
  status_ = 3;
  EXPECT_THROW(parallel_.for_each(2, [](size_t) {}), Error);
  EXPECT_NO_THROW(parallel_.for_each(1, [](size_t) {})) << "one index needs no runner";
}

INSTANTIATE_TEST_SUITE_P(Kinds, ParallelTest,
                         testing::Values(Kind{"one_thread", 1, false}, Kind{"threads", 3, false},
                                         Kind{"runner", 0, true}),
                         [](const auto& kind) { return kind.param.name; });

}  // namespace
}  // namespace kiwami
