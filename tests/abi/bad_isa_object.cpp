// SPDX-License-Identifier: Apache-2.0
// An object with every fault that the checks of ISA objects are there to find.

// An inline function outside the ISA's namespace: the linker would keep the copy of one ISA for
// all.
__attribute__((noinline)) inline int shared_by_all_isas(int value) { return value + 1; }

namespace kiwami::sse {
int from_another_isa(int value) { return shared_by_all_isas(value); }
}  // namespace kiwami::sse

namespace kiwami::scalar {
int initialised_data = 7;
int zeroed_data[4];
int initialised_at_load = kiwami::sse::from_another_isa(initialised_data);
}  // namespace kiwami::scalar
