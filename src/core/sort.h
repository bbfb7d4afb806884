/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file sort.h
 * Sorting in place: no memory but a few words of the stack, in n log n steps whatever the order.
 */
#ifndef MUSTER_CORE_SORT_H
#define MUSTER_CORE_SORT_H

#include <stddef.h>

/** @return below, equal to or above 0, as one comes before, with or after other */
typedef int mu_sort_compare(const void *one, const void *other, const void *context);

/**
 * Puts items in order, the smallest first; equal ones come in any order.  Items in order cost one
 * pass.
 *
 * @param count, size  so many items of so many bytes
 * @param context      passed on to compare
 */
void mu_sort(void *items, size_t count, size_t size, mu_sort_compare *compare, const void *context);

#endif
