/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file wound.h
 * Recordings, and bytes of samples, with wounds: written over, taken out, put in, cut off; with
 * numbers that lengths and places are least ready for.
 */
#ifndef MUSTER_TESTS_WOUND_H
#define MUSTER_TESTS_WOUND_H

#include "core/random.h"
#include "mcap/mcap_bytes.h"

#include <stddef.h>
#include <string.h>
#include <zlib.h>

/* What is wounded grows by no more than so many bytes. */
enum { WOUND_MOST = 6, WOUND_ROOM = WOUND_MOST * 8 };

static inline uint64_t wound_number(const uint8_t *at, size_t bytes)
{
    uint64_t value = 0;
    for (size_t i = bytes; i > 0; i--) {
        value = value << 8 | at[i - 1];
    }
    return value;
}

static inline void wound_set(uint8_t *at, uint64_t value, size_t bytes)
{
    for (size_t i = 0; i < bytes; i++) {
        at[i] = (uint8_t)(value >> (8 * i));
    }
}

/** Writes the checksums of a recording anew, as far as records can be followed. */
static inline void wound_mend(uint8_t *bytes, size_t len)
{
    for (size_t at = MCAP_MAGIC_BYTES; at + MCAP_HEAD_BYTES <= len;) {
        uint64_t size = wound_number(bytes + at + 1, 8);
        if (size > len - at - MCAP_HEAD_BYTES) {
            break;
        }
        uint8_t *content = bytes + at + MCAP_HEAD_BYTES;
        if (bytes[at] == MCAP_CHUNK && size >= MCAP_CHUNK_BYTES) {
            wound_set(content + MCAP_CHUNK_CRC_AT,
                      crc32_z(0, content + MCAP_CHUNK_BYTES, size - MCAP_CHUNK_BYTES), 4);
        }
        at += MCAP_HEAD_BYTES + size;
    }
    if (len > MCAP_MAGIC_BYTES + MCAP_TAIL_BYTES) {
        uint8_t *footer = bytes + len - MCAP_TAIL_BYTES;
        uint64_t begins = wound_number(footer + MCAP_HEAD_BYTES, 8);
        uint64_t ends = len - MCAP_TAIL_BYTES + MCAP_FOOTER_CRC_AT;
        if (begins < len - MCAP_TAIL_BYTES) {
            wound_set(footer + MCAP_FOOTER_CRC_AT, crc32_z(0, bytes + begins, ends - begins), 4);
        }
    }
}

static inline uint64_t wound_bad(struct mu_random *random)
{
    static const uint64_t bad[] = {0,
                                   1,
                                   8,
                                   255,
                                   65535,
                                   0x7fffffff,
                                   0x80000000,
                                   0xffffffff,
                                   1ull << 40,
                                   1ull << 63,
                                   UINT64_MAX,
                                   UINT64_MAX - 8,
                                   INT64_MAX,
                                   0x7ff0000000000000,  /* infinity */
                                   0x7fefffffffffffff,  /* the largest */
                                   0xffefffffffffffff,  /* and the smallest real */
                                   0x7ff8000000000000}; /* no number */
    return bad[mu_random_between(random, 0, sizeof bad / sizeof bad[0] - 1)];
}

/**
 * Wounds bytes where they lie, up to WOUND_MOST times.
 *
 * @param bytes  room for WOUND_ROOM more
 * @return how many there are now
 */
static inline size_t wound_bytes(struct mu_random *random, uint8_t *bytes, size_t len)
{
    for (int64_t wounds = mu_random_between(random, 1, WOUND_MOST); wounds > 0 && len > 16;
         wounds--) {
        size_t at = (size_t)mu_random_between(random, 0, (int64_t)len - 9);
        size_t count = (size_t)1 << mu_random_between(random, 0, 3);
        switch (mu_random_between(random, 0, 9)) {
        case 0: len = at + 1; break;
        case 1:
            memmove(bytes + at, bytes + at + count, len - at - count);
            len -= count;
            break;
        case 2:
            memmove(bytes + at + count, bytes + at, len - at);
            len += count;
            break;
        case 3:
        case 4:
        case 5: wound_set(bytes + at, wound_bad(random), count); break;
        case 6:
            wound_set(bytes + at, (uint64_t)mu_random_between(random, 0, (int64_t)len), 8);
            break;
        case 7: bytes[at] = (uint8_t)mu_random_between(random, 1, 15); break;
        default: bytes[at] = (uint8_t)mu_random_between(random, 0, 255); break;
        }
    }
    return len;
}

/**
 * Copies a recording with wounds; half of them have their checksums mended, so that they get behind
 * those.
 *
 * @param to  room for WOUND_ROOM more bytes
 * @return how many bytes came out
 */
static inline size_t wound_file(struct mu_random *random, uint8_t *to, const uint8_t *sample,
                                size_t len)
{
    memcpy(to, sample, len);
    len = wound_bytes(random, to, len);
    if (mu_random_between(random, 0, 1)) {
        wound_mend(to, len);
    }
    return len;
}

#endif
