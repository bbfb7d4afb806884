/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_reader.h
 * What the parts of the reader share: the catalogue of a file, and the chunks in memory.
 */
#ifndef MUSTER_MCAP_MCAP_READER_H
#define MUSTER_MCAP_MCAP_READER_H

#include "mcap/mcap.h"
#include "mcap/mcap_bytes.h"
#include "muster/limits.h"

enum {
    READER_IDS = 1 << 16,
    READER_SLOTS = 4, /* chunks in memory at once: so many may overlap in time */
    READER_PAIRS_MAX = 1 << 14,
    READER_TEXT_BYTES = 2 * MU_RECORD_TYPES_BYTES,
    /* The largest chunk that is read: the largest that is written. */
    READER_CHUNK_MAX = (2 << 20) + MU_RECORD_TYPES_BYTES + MU_RECORD_MESSAGE_MAX,
    READER_ENTRIES = READER_CHUNK_MAX / (MCAP_HEAD_BYTES + MCAP_MESSAGE_BYTES) + 1,
    READER_PATH_MAX = 4096,
};

struct reader_chunk {
    uint64_t at, length; /* of its record, as far as the file goes */
    uint64_t first_ns, last_ns;
    bool cut;    /* the file ends in it: no checksum */
    bool broken; /* its checksum or its records are wrong: that was counted */
};

/* A message in a slot. */
struct reader_entry {
    uint64_t log_ns;
    uint32_t at; /* of its content in the slot's bytes */
    uint32_t size;
};

/* A chunk in memory. */
struct reader_slot {
    uint8_t *bytes;               /* READER_CHUNK_MAX: the whole record */
    struct reader_entry *entries; /* in order of time, then of the file */
    uint32_t count, next;
    uint64_t at; /* of the chunk in the file */
};

struct reader_file {
    struct mcap_attachment shown;
    uint64_t at; /* of its content, after the head of the record */
    uint64_t length;
};

struct reader_schema {
    const char *name, *encoding;
    const void *bytes;
    size_t size;
};

struct mcap_reader {
    char path[READER_PATH_MAX];
    int fd;
    uint64_t size; /* of the file */
    bool whole, compressed;
    bool loose;    /* messages stand outside chunks */
    bool believes; /* chunks are read although their checksums are wrong */
    bool full;     /* something is more than the limits allow */
    uint64_t broken;
    bool counted; /* the summary says how much there is: */
    uint64_t said_channels, said_messages;
    struct mcap_out text;  /* what the catalogue's texts lie in */
    uint32_t *channel_ids; /* of READER_IDS: index, or MU_NONE */
    uint32_t *schema_ids;
    struct reader_schema schemas[MU_RECORD_CHANNELS_MAX];
    struct mcap_channel channels[MU_RECORD_CHANNELS_MAX];
    bool picked[MU_RECORD_CHANNELS_MAX];
    uint32_t schema_count, channel_count;
    struct mcap_pair *pairs;
    uint32_t pair_count;
    struct reader_file files[MU_RECORD_FILES_MAX];
    struct mcap_table tables[MU_RECORD_FILES_MAX];
    uint32_t file_count, table_count;
    struct reader_chunk *chunks; /* in order of first_ns, then of the file */
    uint32_t chunk_count;
    struct reader_slot slots[READER_SLOTS];
    uint32_t next_chunk;
    uint64_t from_ns, until_ns;
};

/** Reads bytes of the file.  @return MU_OK; MU_MALFORMED: it is not so long; MU_FAULT_OS */
MU_MUST_USE mu_result mcap_reader_bytes(const struct mcap_reader *r, uint64_t at, void *to,
                                        size_t count);

/* The catalogue: each takes the content of a record.  @return each: false when it is malformed */
void mcap_catalog_reset(struct mcap_reader *r);
bool mcap_catalog_schema(struct mcap_reader *r, struct mcap_in in);
bool mcap_catalog_channel(struct mcap_reader *r, struct mcap_in in);
bool mcap_catalog_table(struct mcap_reader *r, struct mcap_in in);
bool mcap_catalog_statistics(struct mcap_reader *r, struct mcap_in in);

/** Takes in an attachment: in holds as much of its content as names it. */
bool mcap_catalog_file(struct mcap_reader *r, struct mcap_in in, uint64_t at, uint64_t length);

/** Takes in a chunk. */
bool mcap_catalog_chunk(struct mcap_reader *r, const struct reader_chunk *chunk);

/**
 * Reads a chunk into a slot: its messages, if their channels are known.
 *
 * @param learns  while the file is opened: schemas and channels in it go into the catalogue, and
 *                messages are counted.  Later the catalogue is what opening has found
 * @return MU_OK; MU_MALFORMED: it is broken, and nothing is in the slot; MU_FAULT_OS
 */
MU_MUST_USE mu_result mcap_chunk_load(struct mcap_reader *r, struct reader_slot *slot,
                                      struct reader_chunk *chunk, bool learns);

#endif
