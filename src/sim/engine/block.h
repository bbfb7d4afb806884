/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file block.h
 * A block of numbers that is the same on every machine: 8 bytes each, the lowest first.
 *
 * One walk over a state writes it, checks it, or reads it, by the block's mode; so what is written
 * and what is read cannot differ.
 */
#ifndef MUSTER_SIM_BLOCK_H
#define MUSTER_SIM_BLOCK_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum block_mode {
    BLOCK_MEASURE, /* count and sum up only */
    BLOCK_WRITE,
    BLOCK_CHECK, /* look at what is there; change nothing */
    BLOCK_READ
};

struct block {
    enum block_mode mode;
    unsigned char *bytes;
    size_t room, used;
    uint64_t sum; /* FNV-1a of all bytes so far */
    bool bad;     /* a number was missing, or not what it may be */
};

struct block block_open(enum block_mode mode, unsigned char *bytes, size_t room);

/** @return the number, which is at most `most` */
uint64_t block_number(struct block *block, uint64_t *value, uint64_t most);

/** A finite number from lo to hi. */
void block_double(struct block *block, double *value, double lo, double hi);

void block_flag(struct block *block, bool *value);

/** @return an index below count, or -1 */
int32_t block_index(struct block *block, int32_t *value, size_t count);

#endif
