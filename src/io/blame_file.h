// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "core/error.h"

namespace kiwami::file {

/// Runs body; what it finds wrong in its arguments (a tree) is wrong with the file that they are
/// from.
template <typename Body>
void blame_file(Body&& body) {
  try {
    body();
  } catch (const Error& error) {
    if (error.result() != KIWAMI_ERROR_INVALID_ARGUMENT &&
        error.result() != KIWAMI_ERROR_VALIDATION) {
      throw;
    }
    throw Error(KIWAMI_ERROR_INVALID_FILE, "the file is damaged: %s", error.what());
  }
}

}  // namespace kiwami::file
