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

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/*
 * The words of an MCAP file (version 1.0): opcodes, the magic, how long the parts of records are.
 *
 * A file is the magic, a header, data, a summary, a footer, the magic.  All of it is records: an
 * opcode, eight bytes of length, and so many bytes.  Numbers are little-endian.
 */
enum mcap_op {
    MCAP_HEADER = 0x01,
    MCAP_FOOTER = 0x02,
    MCAP_SCHEMA = 0x03,
    MCAP_CHANNEL = 0x04,
    MCAP_MESSAGE = 0x05,
    MCAP_CHUNK = 0x06,
    MCAP_MESSAGE_INDEX = 0x07,
    MCAP_CHUNK_INDEX = 0x08,
    MCAP_ATTACHMENT = 0x09,
    MCAP_ATTACHMENT_INDEX = 0x0A,
    MCAP_STATISTICS = 0x0B,
    MCAP_METADATA = 0x0C,
    MCAP_METADATA_INDEX = 0x0D,
    MCAP_SUMMARY_OFFSET = 0x0E,
    MCAP_DATA_END = 0x0F,
};

enum {
    MCAP_MAGIC_BYTES = 8,
    MCAP_HEAD_BYTES = 9,          /* opcode and length */
    MCAP_MESSAGE_BYTES = 22,      /* of a message before its data */
    MCAP_CHUNK_BYTES = 40,        /* of an uncompressed chunk before its records */
    MCAP_CHUNK_CRC_AT = 24,       /* in a chunk */
    MCAP_FOOTER_BYTES = 20,       /* of a footer */
    MCAP_FOOTER_CRC_AT = 9 + 16,  /* from its opcode on: the CRC goes as far */
    MCAP_INDEX_ENTRY_BYTES = 16,  /* of a message index */
    MCAP_TAIL_BYTES = 9 + 20 + 8, /* footer and magic */
};

#define MCAP_MAGIC ((const uint8_t *)"\x89MCAP0\r\n")

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
