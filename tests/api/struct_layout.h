/* SPDX-License-Identifier: Apache-2.0 */
/* What the parts of struct_layout_test share. */
#ifndef KIWAMI_TESTS_STRUCT_LAYOUT_H
#define KIWAMI_TESTS_STRUCT_LAYOUT_H

#include <kiwami/kiwami.h>

/* Counts and prints a difference. */
void expect(const char* what, size_t actual, size_t expected);

#define SIZE(type, expected) expect("sizeof " #type, sizeof(type), expected)
#define FIELD(type, field, expected) expect(#type "." #field, offsetof(type, field), expected)

/* Each part checks the structs and numbers of some headers. */
void check_tree_layouts(void);  /* bvh.h, export.h, io.h */
void check_light_layouts(void); /* light.h, distribution.h */

#endif
