/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_bytes.h
 * Little-endian numbers and texts with a length before them, into and out of bytes in memory.
 *
 * Nothing is written past the room or read past the end: what does not fit, or is not there, is
 * remembered and can be asked for once, at the end.
 */
#ifndef MUSTER_MCAP_MCAP_BYTES_H
#define MUSTER_MCAP_MCAP_BYTES_H

#include "mcap/mcap_format.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Room that is filled from its beginning. */
struct mcap_out {
    uint8_t *at;
    size_t len, size;
    bool full; /* something did not fit, and was left out */
};

void mcap_out_number(struct mcap_out *o, uint64_t value, size_t bytes);
void mcap_out_bytes(struct mcap_out *o, const void *bytes, size_t count);

/** Writes the length in four bytes, and the text without its zero. */
void mcap_out_text(struct mcap_out *o, const char *text);

/** Begins a part whose length, in so many bytes, is not known yet.  @return where it begins */
size_t mcap_out_begin(struct mcap_out *o, size_t bytes);

/** Ends that part: writes its length. */
void mcap_out_end(struct mcap_out *o, size_t begun, size_t bytes);

/** Begins a record.  @return for mcap_out_record_end */
size_t mcap_out_record(struct mcap_out *o, enum mcap_op op);

void mcap_out_record_end(struct mcap_out *o, size_t begun);

/* Bytes that are read from their beginning. */
struct mcap_in {
    const uint8_t *at;
    size_t left;
    bool cut; /* more was asked for than there was */
};

/** @return the number; 0 when it is not there */
uint64_t mcap_in_number(struct mcap_in *in, size_t bytes);

/** @return the next bytes; NULL when there are not so many */
const uint8_t *mcap_in_bytes(struct mcap_in *in, uint64_t count);

/** Takes a part out whose length stands before it in so many bytes; an empty one when it is cut. */
struct mcap_in mcap_in_part(struct mcap_in *in, size_t bytes);

#endif
