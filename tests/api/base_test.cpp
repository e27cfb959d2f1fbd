// SPDX-License-Identifier: Apache-2.0
// Versions, names, and the last error.
#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <thread>

#include "api/api_support.h"

namespace kiwami_api_tests {
namespace {

TEST(Base, VersionsAreThoseOfTheHeader) {
  EXPECT_EQ(kiwami_version(), 1000u);
  EXPECT_EQ(kiwami_abi_version(), 0u);
}

TEST(Base, EveryResultHasItsOwnName) {
  std::string names;
  for (kiwami_result result = KIWAMI_OK; result >= KIWAMI_ERROR_CANCELLED; --result) {
    const std::string name = kiwami_result_name(result);
    EXPECT_NE(name, "unknown result");
    EXPECT_EQ(names.find("[" + name + "]"), std::string::npos) << name;
    names += "[" + name + "]";
  }
  EXPECT_STREQ(kiwami_result_name(1), "unknown result");
  EXPECT_STREQ(kiwami_result_name(KIWAMI_ERROR_CANCELLED - 1), "unknown result");
}

TEST(LastError, IsCutToTheCapacityAndSaysWhatTheWholeNeeds) {
  ASSERT_EQ(kiwami_scene_commit(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  const std::string whole = "scene is NULL, expected a valid pointer";
  EXPECT_EQ(last_error(), whole);
  EXPECT_EQ(kiwami_last_error(nullptr, nullptr, 0), whole.size() + 1);
  char text[8];
  std::memset(text, 'x', sizeof text);
  EXPECT_EQ(kiwami_last_error(nullptr, text, 6), whole.size() + 1);
  EXPECT_EQ(std::string(text), "scene");
  EXPECT_EQ(text[6], 'x');
}

TEST(LastError, StaysAfterSuccess) {
  ASSERT_EQ(kiwami_scene_commit(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  const std::string before = last_error();
  kiwami_device_desc desc;
  ASSERT_EQ(kiwami_device_desc_init(&desc, sizeof desc), KIWAMI_OK);
  EXPECT_EQ(last_error(), before);
}

TEST(LastError, BelongsToItsThread) {
  ASSERT_EQ(kiwami_scene_commit(nullptr), KIWAMI_ERROR_INVALID_ARGUMENT);
  std::string other = "unset";
  std::thread([&] { other = last_error(); }).join();
  EXPECT_EQ(other, "");
}

TEST(LastError, IsToldApartByDevice) {
  const Device first = make_device(), second = make_device();
  const Scene scene = make_scene(first);
  ASSERT_EQ(kiwami_scene_detach(scene.get(), 3), KIWAMI_ERROR_INVALID_ARGUMENT);
  const std::string sentence = "geometry_id is 3, expected the number of an attached geometry";
  EXPECT_EQ(last_error(first.get()), sentence);
  EXPECT_EQ(last_error(second.get()), "");
  EXPECT_EQ(last_error(), sentence);
}

}  // namespace
}  // namespace kiwami_api_tests
