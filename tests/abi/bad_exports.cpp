// SPDX-License-Identifier: Apache-2.0
// A library that exports what nobody declared.
extern "C" int stray_symbol() { return 0; }
