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

#include <dds/dds.h>
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

/* --- frames ----------------------------------------------------------------------------------- */

/* A sample as it goes, by sockets (local.h) or by DDS.  Four bytes are the size of all, in the byte
 * order of the host.  Behind them is what RTPS calls a serialized payload (RTPS 2.2, 10.2): four
 * bytes that say how it is encoded, and the CDR.  Zeros fill the frame up to the next multiple of
 * this. */
enum { CDR_FRAME_HEAD = 8 };

/** Makes a frame of a sample, at the beginning of the room.  @return where the CDR ends */
size_t cdr_frame(struct cdr_room *room, const void *sample, const uint32_t *ops);

/**
 * Writes the sample of a frame by DDS.
 *
 * The same by dds_write keeps 4 KiB of memory for a sample of 200 bytes until all readers have
 * acknowledged it; this keeps its size.
 *
 * @param end        of the CDR
 * @param source_ns  the time of the sample
 * @return as dds_write_ts
 */
dds_return_t cdr_frame_write(dds_entity_t writer, const char *frame, size_t end,
                             dds_time_t source_ns);

#endif
