/* SPDX-License-Identifier: Apache-2.0
 *
 * Kiwami: discrete distributions: numbers drawn in proportion to weights, in constant time on
 * average: a light by its power, a triangle by its area, a texel of an environment by its
 * brightness. See docs/distributions.md.
 *
 * Which number is drawn, and with which probability, is the same to the bit on every machine and for
 * every number of threads.
 */
#ifndef KIWAMI_DISTRIBUTION_H
#define KIWAMI_DISTRIBUTION_H

#include "device.h"

#ifdef __cplusplus
extern "C" {
#endif

/* A reference-counted handle of a distribution, which never changes. It holds its device. */
typedef struct kiwami_distribution kiwami_distribution;

enum {
  /* A radix tree forest (Binder & Keller 2019): greater random numbers draw greater numbers, so
   * that the evenness of stratified and low-discrepancy sequences is kept. 20 bytes a weight. */
  KIWAMI_DISTRIBUTION_RADIX_TREE_FOREST = 0,
  /* An alias table (Walker 1977): one look, in any case. Neighbouring random numbers draw unrelated
   * numbers. 16 bytes a weight. */
  KIWAMI_DISTRIBUTION_ALIAS_TABLE = 1
};

/* How a distribution is made. */
typedef struct kiwami_distribution_desc {
  uint32_t struct_size;   /* bytes of this struct, set by kiwami_distribution_desc_init */
  uint32_t method;        /* KIWAMI_DISTRIBUTION_*; RADIX_TREE_FOREST */
  const void* weights;    /* one float each, 0 or more, finite, not all of them 0: only ratios
                           * count. At any address; read during the call only */
  uint64_t weight_stride; /* bytes from one to the next, at least 4; 0: 4 */
  uint64_t weight_count;  /* 1 to 2^31 - 1 */
} kiwami_distribution_desc;

/* The numbers of a distribution. */
typedef struct kiwami_distribution_info {
  uint32_t struct_size;  /* set by the caller to sizeof(kiwami_distribution_info) */
  uint32_t method;       /* KIWAMI_DISTRIBUTION_* */
  uint64_t weight_count; /* as it was given */
  uint64_t bytes;        /* memory of the handle */
  double total;          /* the sum of all weights */
  double mean_steps;     /* comparisons of a draw, on average over all random numbers */
  uint32_t most_steps;   /* comparisons of a draw at most */
  uint32_t reserved;     /* 0 */
} kiwami_distribution_info;

/* A number that was drawn. 16 bytes, at any address. */
typedef struct kiwami_draw {
  uint32_t index;    /* of the weight, which is not 0 */
  float probability; /* with which it is drawn, above 0 */
  double random;     /* a new random number, at least 0 and below 1, independent of the index */
} kiwami_draw;

/* Fills *desc with the defaults: no weights.
 *   size      sizeof the struct as the caller knows it
 *   errors    INVALID_ARGUMENT: desc is NULL, or size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_distribution_desc_init(kiwami_distribution_desc* desc, size_t size);

/* Makes a distribution, on the device's threads.
 *   distribution   receives the handle, with one reference, or NULL on error
 *   errors         INVALID_ARGUMENT: NULL, a field of desc, a weight that is negative or not finite
 *                  (the sentence names it), weights that are all 0; TOO_LARGE: more than 2^31 - 1
 *                  weights; OUT_OF_MEMORY; CALLBACK: the runner failed
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_distribution_create(kiwami_device* device,
                                                    const kiwami_distribution_desc* desc,
                                                    kiwami_distribution** distribution);

/* Adds a reference. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_distribution_retain(kiwami_distribution* distribution);

/* Drops a reference; the last one ends the distribution. NULL is ignored. [any thread]; since 0.1 */
KIWAMI_API void kiwami_distribution_release(kiwami_distribution* distribution);

/* Says what a distribution is.
 *   info      struct_size set by the caller; the fields that fit are filled
 *   errors    INVALID_ARGUMENT: NULL, or struct_size is below 8
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_distribution_get_info(const kiwami_distribution* distribution,
                                                      kiwami_distribution_info* info);

/* Draws a number for each random number. A weight smaller than 2^-53 of all may never be drawn.
 *   randoms   count doubles, random_stride bytes apart (0: 8), at least 0 and below 1 (what is below
 *             or not a number counts as 0, what is above as the greatest below 1); NULL only if
 *             count is 0
 *   draws     receives count draws, draw_stride bytes apart (0: sizeof(kiwami_draw)). May not
 *             overlap the random numbers.
 * Large batches run on the device's threads. Nothing is allocated.
 *   errors    INVALID_ARGUMENT: distribution is NULL; CALLBACK: the runner failed. With
 *             KIWAMI_DEVICE_VALIDATE also INVALID_ARGUMENT: NULL, a stride too small, an extent that
 *             overflows
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_distribution_sample(const kiwami_distribution* distribution,
                                                    const double* randoms, size_t random_stride,
                                                    kiwami_draw* draws, size_t draw_stride,
                                                    size_t count);

/* The probability with which each number is drawn: to the bit that of kiwami_distribution_sample.
 *   indices         count uint32, index_stride bytes apart (0: 4). What is no number of a weight has
 *                   probability 0.
 *   probabilities   receives count floats, probability_stride bytes apart (0: 4)
 * Otherwise as kiwami_distribution_sample.
 * [any thread]; since 0.1 */
KIWAMI_API kiwami_result kiwami_distribution_pdf(const kiwami_distribution* distribution,
                                                 const uint32_t* indices, size_t index_stride,
                                                 float* probabilities, size_t probability_stride,
                                                 size_t count);

#ifdef __cplusplus
}
#endif

#endif
