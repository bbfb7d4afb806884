/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file memory.h
 * Memory is taken while a process starts, and never afterwards.
 */
#ifndef MUSTER_MEMORY_H
#define MUSTER_MEMORY_H

#include <stdbool.h>
#include <stddef.h>

#pragma GCC visibility push(default)
#ifdef __cplusplus
extern "C" {
#endif

/** Takes zeroed memory for the life of the process.  Aborts after the seal, or when there is none.
 */
void *mu_startup_alloc(size_t bytes);

/** As mu_startup_alloc, for count things of one size; aborts when the product overflows. */
void *mu_startup_array(size_t count, size_t bytes);

/** Copies a string for the life of the process. */
char *mu_startup_string(const char *text);

/** Ends the start-up phase: from here on, mu_startup_alloc aborts. */
void mu_memory_seal(void);

/** @return whether the start-up phase is over */
bool mu_memory_sealed(void);

#ifdef __cplusplus
}
#endif
#pragma GCC visibility pop

#endif
