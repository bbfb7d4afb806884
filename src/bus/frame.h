/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file frame.h
 * A sample of a topic with sockets (local.h) as it goes, by them or by DDS.
 *
 * Four bytes are the size of all, in the byte order of the host.  Behind them is what RTPS calls a
 * serialized payload (RTPS 2.2, 10.2): four bytes that say how it is encoded, and the CDR.  Zeros
 * fill the frame up to the next multiple of FRAME_HEAD.
 */
#ifndef MUSTER_BUS_FRAME_H
#define MUSTER_BUS_FRAME_H

#include "bus/cdr.h"

#include <dds/dds.h>

enum { FRAME_HEAD = 8 };

/** Makes a frame of a sample, at the beginning of the room.  @return where the CDR ends */
size_t frame_put(struct cdr_room *room, const void *sample, const uint32_t *ops);

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
dds_return_t frame_write(dds_entity_t writer, const char *frame, size_t end, dds_time_t source_ns);

#endif
