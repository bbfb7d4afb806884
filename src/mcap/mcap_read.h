/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_read.h
 * Reads a recording: what channels it has, its attached files and tables, and messages in order of
 * time.
 *
 *     struct mcap_reader *r = mcap_reader_create();
 *     MU_TRY(mcap_reader_open(r, "run.mcap", &fault));
 *     mcap_reader_pick(r, mcap_reader_find(r, "Frame"), true);
 *     mcap_reader_seek(r, from_ns, until_ns);
 *     while (mcap_reader_next(r, &message) == MU_OK) ...
 *
 * A file without a summary, or one that ends anywhere, is read as far as it goes.  Nothing in a
 * file is believed: each length is checked, and a chunk whose checksum is wrong is left out and
 * counted.  Compressed chunks are refused, and so are messages in no chunk.
 */
#ifndef MUSTER_MCAP_MCAP_READ_H
#define MUSTER_MCAP_MCAP_READ_H

#include "core/fault.h"
#include "core/table.h"
#include "mcap/mcap_channel.h"

#include <stdbool.h>

struct mcap_reader;

/* A file in the recording.  Its name comes from the recording: no path to write to unlooked at. */
struct mcap_attachment {
    const char *name, *media_type;
    uint64_t size;
};

/* A table of keys and values. */
struct mcap_table {
    const char *name;
    const struct mcap_pair *pairs;
    size_t count;
};

/** Takes the memory of a reader, at start-up. */
struct mcap_reader *mcap_reader_create(void);

/**
 * Opens a file and reads what there is in it; one that was open is closed.  All channels are
 * picked, and the first message is the next one.
 *
 * @param fault  filled for MU_FAULT_FILE: no MCAP file, compressed, past a limit; unreadable
 */
MU_MUST_USE mu_result mcap_reader_open(struct mcap_reader *r, const char *path,
                                       struct mu_fault *fault);

void mcap_reader_close(struct mcap_reader *r);

/** @return whether the file has its summary: whoever wrote it came to its end */
bool mcap_reader_whole(const struct mcap_reader *r);

/** @return chunks that were left out because their checksum or their records were wrong */
uint64_t mcap_reader_broken(const struct mcap_reader *r);

/** Has chunks read, from the next open on, although their checksums are wrong; they are counted all
 * the same.  For who looks for what was changed. */
void mcap_reader_believe(struct mcap_reader *r);

/** The times of the first and the last message.  @return false: there are no messages */
bool mcap_reader_span(const struct mcap_reader *r, uint64_t *first_ns, uint64_t *last_ns);

/** @return how many channels there are */
uint32_t mcap_reader_channels(const struct mcap_reader *r);

/** @return a channel; it and its texts live until the next open */
const struct mcap_channel *mcap_reader_channel(const struct mcap_reader *r, uint32_t index);

/** @return the index of the first channel of a topic, or MU_NONE */
uint32_t mcap_reader_find(const struct mcap_reader *r, const char *topic);

/** @return an attached file by index; NULL past the last */
const struct mcap_attachment *mcap_reader_attachment(const struct mcap_reader *r, uint32_t index);

/** @return the index of the first attached file of that name, or MU_NONE */
uint32_t mcap_reader_attachment_find(const struct mcap_reader *r, const char *name);

/**
 * Reads an attached file.
 *
 * @param to  room for so many bytes
 * @return MU_OK; MU_FULL: it is larger; MU_MALFORMED: its checksum is wrong; MU_FAULT_OS
 */
MU_MUST_USE mu_result mcap_reader_attachment_read(struct mcap_reader *r, uint32_t index, void *to,
                                                  size_t size);

/** @return a table by index; NULL past the last */
const struct mcap_table *mcap_reader_table(const struct mcap_reader *r, uint32_t index);

/** @return the value of a key in the first table of a name that has it; NULL: there is none */
const char *mcap_reader_value(const struct mcap_reader *r, const char *table, const char *key);

/** Picks a channel, or leaves it out; holds from the next seek on, and until the next open. */
void mcap_reader_pick(struct mcap_reader *r, uint32_t channel, bool picked);

/** Goes to a time: next gives messages of from_ns to until_ns, both included. */
void mcap_reader_seek(struct mcap_reader *r, uint64_t from_ns, uint64_t until_ns);

/**
 * Gives the next message in order of time; of equal times, in the order of the file.
 *
 * @param message  its data live until the next call
 * @return MU_OK; MU_DONE: there is none any more; MU_FAULT_OS: the file cannot be read
 */
MU_MUST_USE mu_result mcap_reader_next(struct mcap_reader *r, struct mcap_message *message);

#endif
