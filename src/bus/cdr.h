/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file cdr.h
 * Samples as the CDR of their topic (XCDR version 1, DDS-XTypes 1.3, 7.4.1), in the byte order of
 * the host.
 *
 * The bytes are those that DDS writes, by the same tables (dds_opcodes.h), and what DDS refuses is
 * refused here.  DDS walks a sample twice: an Up with one mail takes it 8,900 instructions to read,
 * and 2,700 here.
 */
#ifndef MUSTER_BUS_CDR_H
#define MUSTER_BUS_CDR_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Room that grows; its memory is DDS's. */
struct cdr_room {
    char *at;
    size_t size;
};

/** Writes a sample at a multiple of 8 of the room.
 * @return where it ends; there is room for 8 bytes behind it */
size_t cdr_put(struct cdr_room *room, size_t at, const void *sample, const uint32_t *ops);

/** Reads a sample over one that was there, whose memory is DDS's and is used again.
 * @return false: the bytes are none; then the sample may hold a part of them */
bool cdr_take(void *sample, const char *from, size_t size, const uint32_t *ops);

#endif
