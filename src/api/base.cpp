// SPDX-License-Identifier: Apache-2.0
#include "kiwami/base.h"

#include <algorithm>
#include <cstring>

#include "api/check.h"

namespace kiwami::api {

namespace {

/// The last error of a thread. The device is compared, never read.
struct LastError {
  const void* device;
  char sentence[Error::kCapacity];
};

thread_local LastError last_error{};

}  // namespace

kiwami_result report(const Device* device, kiwami_result result, const char* sentence) noexcept {
  last_error.device = device;
  const size_t length = std::min(std::strlen(sentence), sizeof(last_error.sentence) - 1);
  std::memcpy(last_error.sentence, sentence, length);
  last_error.sentence[length] = '\0';
  if (device) device->log(result, last_error.sentence);
  return result;
}

}  // namespace kiwami::api

extern "C" {

uint32_t kiwami_version(void) {
  return KIWAMI_VERSION_MAJOR * 1000000 + KIWAMI_VERSION_MINOR * 1000 + KIWAMI_VERSION_PATCH;
}

uint32_t kiwami_abi_version(void) { return KIWAMI_ABI_VERSION; }

const char* kiwami_result_name(kiwami_result result) {
  switch (result) {
    case KIWAMI_OK:
      return "ok";
    case KIWAMI_ERROR_INVALID_ARGUMENT:
      return "invalid argument";
    case KIWAMI_ERROR_INVALID_STATE:
      return "invalid state";
    case KIWAMI_ERROR_OUT_OF_MEMORY:
      return "out of memory";
    case KIWAMI_ERROR_UNSUPPORTED_ISA:
      return "unsupported instruction set";
    case KIWAMI_ERROR_TOO_LARGE:
      return "too large";
    case KIWAMI_ERROR_CALLBACK:
      return "callback failed";
    case KIWAMI_ERROR_VALIDATION:
      return "validation failed";
    case KIWAMI_ERROR_INTERNAL:
      return "internal error";
    case KIWAMI_ERROR_CAPACITY:
      return "capacity exceeded";
    case KIWAMI_ERROR_INVALID_FILE:
      return "invalid file";
    case KIWAMI_ERROR_CANCELLED:
      return "cancelled";
    case KIWAMI_ERROR_IO:
      return "input or output failed";
    default:
      return "unknown result";
  }
}

size_t kiwami_last_error(const kiwami_device* device, char* text, size_t capacity) {
  const kiwami::api::LastError& last = kiwami::api::last_error;
  const char* sentence = !device || device == last.device ? last.sentence : "";
  const size_t needed = std::strlen(sentence) + 1;
  if (text && capacity != 0) {
    const size_t length = std::min(needed, capacity) - 1;
    std::memcpy(text, sentence, length);
    text[length] = '\0';
  }
  return needed;
}

}  // extern "C"
