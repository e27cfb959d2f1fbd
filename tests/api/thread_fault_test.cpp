// SPDX-License-Identifier: Apache-2.0
// No thread can be started, or only some: calls come back, with the right answers. A process of its
// own for each number of threads, since schedulers start their threads once.
#include <dlfcn.h>
#include <gtest/gtest.h>
#include <pthread.h>
#include <sys/wait.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>

#include "api/api_support.h"

namespace {

std::atomic<int> threads_left{1 << 30};
std::atomic<int> refusals{0};

}  // namespace

// Takes the place of the system's in the whole process, the task scheduler included.
extern "C" int pthread_create(pthread_t* thread, const pthread_attr_t* attributes,
                              void* (*start)(void*), void* argument) {
  using Function = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  static auto* const create = reinterpret_cast<Function*>(dlsym(RTLD_NEXT, "pthread_create"));
  if (threads_left.fetch_sub(1) <= 0) {
    ++refusals;
    return EAGAIN;
  }
  return create(thread, attributes, start, argument);
}

namespace kiwami_api_tests {
namespace {

/// Builds twice and traces; the answers must be those of a device without threads. Returns 0.
int run(int threads) {
  const Triangles triangles = random_triangles(30000, 4);
  const std::vector<kiwami_ray> rays = random_rays(30000, 4);
  kiwami_device_desc alone = default_device();
  alone.thread_count = 1;
  const Device reference = make_device(alone);
  const std::vector<kiwami_hit> expected =
      closest_hits(make_scene(reference, make_mesh(reference, triangles.desc())), rays);
  threads_left = threads;
  const Device device = make_device();
  for (int i = 0; i < 2; ++i) {
    const Scene scene = make_scene(device, make_mesh(device, triangles.desc()));
    if (!are_equal(closest_hits(scene, rays), expected)) return 1;
    if (kiwami_scene_validate(scene.get()) != KIWAMI_OK) return 2;
  }
  if (::testing::Test::HasFailure()) return 3;
  return 0;
}

TEST(ThreadFault, CallsAnswerWithoutThreads) {
  for (int threads = 0; threads < 4; ++threads) {
    const pid_t child = ::fork();
    ASSERT_GE(child, 0);
    if (child == 0) ::_exit(run(threads));
    int status = 0;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_TRUE(WIFEXITED(status)) << threads << " threads, signal " << WTERMSIG(status);
    EXPECT_EQ(WEXITSTATUS(status), 0) << threads << " threads";
  }
}

TEST(ThreadFault, IsReallyInjected) {
  threads_left = 0;
  pthread_t thread;
  EXPECT_EQ(pthread_create(
                &thread, nullptr, [](void*) -> void* { return nullptr; }, nullptr),
            EAGAIN);
  EXPECT_EQ(refusals, 1);
}

}  // namespace
}  // namespace kiwami_api_tests
