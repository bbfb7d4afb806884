/* SPDX-License-Identifier: Apache-2.0 */
#include "sim/engine/engine_core.h"

#include <string.h>

enum { BLOCK_NUMBER = 8 };

struct block block_open(enum block_mode mode, unsigned char *bytes, size_t room)
{
    return (struct block){
        .mode = mode, .bytes = bytes, .room = room, .sum = 14695981039346656037ull};
}

static bool block_takes_in(const struct block *block)
{
    return block->mode == BLOCK_CHECK || block->mode == BLOCK_READ;
}

/* Passes one number to or from the block.  @return the number; 0 if the block is bad */
static uint64_t block_pass(struct block *block, uint64_t value)
{
    bool stored = block->mode != BLOCK_MEASURE;
    if (stored && block->room - block->used < BLOCK_NUMBER) {
        block->bad = true;
        return 0;
    }
    uint64_t passed = 0;
    for (unsigned i = 0; i < BLOCK_NUMBER; i++) {
        unsigned char byte = (unsigned char)(value >> (8 * i));
        if (block_takes_in(block)) {
            byte = block->bytes[block->used + i];
        } else if (stored) {
            block->bytes[block->used + i] = byte;
        }
        block->sum = (block->sum ^ byte) * 1099511628211ull;
        passed |= (uint64_t)byte << (8 * i);
    }
    block->used += BLOCK_NUMBER;
    return passed;
}

uint64_t block_number(struct block *block, uint64_t *value, uint64_t most)
{
    uint64_t passed = block_pass(block, *value);
    block->bad = block->bad || passed > most;
    if (block->mode == BLOCK_READ) {
        *value = passed;
    }
    return passed;
}

void block_double(struct block *block, double *value, double lo, double hi)
{
    uint64_t bits;
    double passed;
    memcpy(&bits, value, sizeof bits);
    bits = block_pass(block, bits);
    memcpy(&passed, &bits, sizeof passed);
    block->bad = block->bad || !(isfinite(passed) && passed >= lo && passed <= hi);
    if (block->mode == BLOCK_READ) {
        *value = passed;
    }
}

void block_flag(struct block *block, bool *value)
{
    uint64_t number = *value;
    (void)block_number(block, &number, 1);
    *value = number != 0; /* unchanged unless the mode is BLOCK_READ */
}

int32_t block_index(struct block *block, int32_t *value, size_t count)
{
    uint64_t number = (uint64_t)(*value + 1);
    int32_t passed = (int32_t)block_number(block, &number, count) - 1;
    if (block->mode == BLOCK_READ) {
        *value = passed;
    }
    return passed;
}
