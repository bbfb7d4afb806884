/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_writer.h
 * What the parts of the writer share: data as they come, and the summary at the end.
 */
#ifndef MUSTER_MCAP_MCAP_WRITER_H
#define MUSTER_MCAP_MCAP_WRITER_H

#include "mcap/mcap.h"
#include "mcap/mcap_bytes.h"
#include "muster/limits.h"

#include <sys/uio.h>

enum {
    WRITER_CHUNK_BYTES = 1 << 20,    /* a chunk is closed when it has so many */
    WRITER_CHUNK_MESSAGES = 1 << 14, /* or so many messages */
    WRITER_PATH_MAX = 4096,
    WRITER_NONE = -1,
};

/* A message of the chunk at hand, for the index. */
struct writer_entry {
    uint64_t log_ns, at; /* at: in the chunk's records */
    int32_t next;        /* of the same channel; WRITER_NONE: the last one */
};

struct writer_channel {
    int32_t first, last; /* entries of the chunk at hand */
    uint32_t entries;
    uint64_t messages; /* of the whole file */
};

struct writer_span {
    bool any; /* else neither is meant */
    uint64_t first_ns, last_ns;
};

struct mcap_writer {
    char path[WRITER_PATH_MAX];
    int fd;
    int error;       /* of the disk, the first one; 0: none */
    uint64_t offset; /* bytes written */
    uint64_t refused;
    struct mcap_out chunk; /* the record: head, and what has come since the last one */
    uint64_t chunk_began_ns;
    struct writer_span chunk_span, span;
    struct writer_entry *entries; /* WRITER_CHUNK_MESSAGES */
    uint32_t entry_count;
    struct mcap_out index; /* the chunk's message indices */
    struct writer_channel channels[MU_RECORD_CHANNELS_MAX];
    uint32_t channel_count, schema_count;
    struct mcap_out schema_records, channel_records; /* for the summary */
    uint64_t messages;
    uint32_t attachments, tables, chunks;
};

/** Write bytes at the end of the file, or keep the error. */
void mcap_writer_put(struct mcap_writer *w, const void *bytes, size_t count);
void mcap_writer_put_pieces(struct mcap_writer *w, struct iovec *pieces, int count);

/** Writes end of data, summary and footer.  The chunk at hand has been written. */
void mcap_summary_write(struct mcap_writer *w);

#endif
