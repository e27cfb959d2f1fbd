/* SPDX-License-Identifier: Apache-2.0 */
/* An interface that changes in one way or another: what the check of the binary interface finds. */
#include <stdint.h>

typedef struct kiwami_frozen {
  float a;
#if defined(CHANGE_FROZEN)
  float b;
#endif
} kiwami_frozen;

typedef struct kiwami_growing_desc {
  uint32_t struct_size;
  uint32_t flags;
#if defined(CHANGE_GROWN)
  uint64_t more;
#endif
} kiwami_growing_desc;

int kiwami_call(const kiwami_frozen* frozen, const kiwami_growing_desc* desc);
int kiwami_call(const kiwami_frozen* frozen, const kiwami_growing_desc* desc) {
  return frozen->a > 0 && desc->flags != 0;
}

#if defined(CHANGE_PARAMETER)
int kiwami_number(double number);
int kiwami_number(double number) { return number > 0; }
#elif !defined(CHANGE_REMOVED)
int kiwami_number(int number);
int kiwami_number(int number) { return number > 0; }
#endif

#if defined(CHANGE_GROWN)
int kiwami_added(void);
int kiwami_added(void) { return 1; }
#endif
