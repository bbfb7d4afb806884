/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file built.h
 * The structs of a program that another version of the headers may have built.
 */
#ifndef MUSTER_CORE_BUILT_H
#define MUSTER_CORE_BUILT_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

struct built_struct {
    const char *name;
    uint32_t size; /* in this library */
    bool grows;    /* the program may know less of it: its end is new */
};

/**
 * Compares the program's structs with ours; prints the one that does not fit, and what to do.
 *
 * @param sizes  in the program, in the order of ours; a shorter list ends with 0
 * @return whether all fit
 */
bool built_fits(const char *version, const uint32_t *sizes, const struct built_struct *ours,
                size_t count);

#endif
