// SPDX-License-Identifier: Apache-2.0
// Callbacks of the library that call Go. A handle (runtime/cgo) travels as a number: as a pointer it
// would be one that Go's stacks may not hold.
#ifndef KIWAMI_GO_CALLBACKS_H
#define KIWAMI_GO_CALLBACKS_H

#include <kiwami/kiwami.h>

// Fills *query, which is C's memory, with a filter.
void kiwami_go_query_init(kiwami_query* query, uintptr_t handle);

// Sets the progress function of a scene; handle 0: none.
kiwami_result kiwami_go_set_progress(kiwami_scene* scene, uintptr_t handle);

// Makes a user geometry, which owns the handle unless an error is returned.
kiwami_result kiwami_go_user_geometry_create(kiwami_device* device, uint64_t count, uint32_t mask,
                                             uintptr_t handle, kiwami_geometry** geometry);

#endif
