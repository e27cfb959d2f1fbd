// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace kiwami::tools {

/// The page of `inspect --html` before and after its data, bundled from tools/inspect_page; both
/// empty in a build without it.
extern const std::string_view kInspectPageHead;
extern const std::string_view kInspectPageTail;

}  // namespace kiwami::tools
