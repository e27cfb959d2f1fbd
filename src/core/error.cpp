// SPDX-License-Identifier: Apache-2.0
#include "core/error.h"

#include <cstdarg>
#include <cstdio>

namespace kiwami {

Error::Error(kiwami_result result, const char* format, ...) : result_(result) {
  va_list arguments;
  va_start(arguments, format);
  if (std::vsnprintf(text_, sizeof(text_), format, arguments) < 0) text_[0] = '\0';
  va_end(arguments);
}

}  // namespace kiwami
