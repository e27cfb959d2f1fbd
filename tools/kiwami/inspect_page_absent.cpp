// SPDX-License-Identifier: Apache-2.0
#include "kiwami/inspect_page.h"

namespace kiwami::tools {

const std::string_view kInspectPageHead;
const std::string_view kInspectPageTail;

}  // namespace kiwami::tools
