// SPDX-License-Identifier: Apache-2.0
// All that reads what was loaded or built, for tests that only ask that it comes to an end.
#pragma once

#include <kiwami/kiwami.h>

namespace kiwami_tests {

/// Traces, looks at, measures, validates, exports, refits and commits. Whatever the calls return is
/// right but KIWAMI_ERROR_INTERNAL, which throws.
void exercise(kiwami_scene* scene);
void exercise(kiwami_bvh* bvh);
/// Samples by each method, changes, refits and commits.
void exercise(kiwami_light_tree* lights);

}  // namespace kiwami_tests
