/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap.h
 * Recordings: MCAP files, read and written.
 */
#ifndef MUSTER_MCAP_H
#define MUSTER_MCAP_H

#include "core/fault.h"
#include "core/table.h"
#include "core/text.h"

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* A key and its value. */
struct mcap_pair {
    const char *key, *value;
};

/* A topic, and how its messages are to be understood. */
struct mcap_channel {
    const char *topic;
    const char *encoding;        /* of messages: "cdr" */
    const char *schema_name;     /* "muster/msg/Frame"; "": there is no schema */
    const char *schema_encoding; /* "ros2msg" */
    const void *schema;          /* bytes, no zero at the end */
    size_t schema_size;
    const struct mcap_pair *pairs;
    size_t pairs_count;
    uint64_t messages; /* of a channel that is read: how many; 0: the file does not say */
};

struct mcap_message {
    uint32_t channel;    /* index of the channel, in the order in which they were added */
    uint32_t sequence;   /* of the recorder; as good as any number */
    uint64_t log_ns;     /* the time that recordings are sorted by; of a run: simulated */
    uint64_t publish_ns; /* when it was written, nanoseconds since 1970 */
    const void *data;
    size_t size;
};

/* --- reading -----------------------------------------------------------------------------------
 */

/*
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

/** @return whether the file has its summary: its writer came to its end */
bool mcap_reader_whole(const struct mcap_reader *r);

/** @return chunks that were left out because their checksum or their records were wrong */
uint64_t mcap_reader_broken(const struct mcap_reader *r);

/** Has chunks read, from the next open on, although their checksums are wrong; they are counted all
 * the same.  For programs that look for what was changed. */
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

/** Adds "muster 0.1.0 on 2026-02-28", or "another program" where the recording does not say it; 100
 * bytes are enough. */
void mcap_origin_write(const struct mcap_reader *r, struct mu_text *to);

/* --- writing -----------------------------------------------------------------------------------
 */

/*
 * Writes a recording: one MCAP file with uncompressed chunks, indices, checksums and a summary.
 *
 * What is written is on its way to the disk at the latest a second later, or when a megabyte has
 * come together; a file whose writer was killed can be read up to there.  All memory is taken once;
 * the summary is made from the file itself, so that a recording may be as long as the disk allows.
 *
 * An error of the disk is kept: from then on nothing is written, and the close tells.
 */

struct mcap_writer;

/** Takes the memory of a writer, at start-up. */
struct mcap_writer *mcap_writer_create(void);

/**
 * Creates the file, or empties it, and writes its head.
 *
 * @param library  the writer, for people: "muster 0.1.0"
 * @return MU_OK or MU_FAULT_OS, said on standard error
 */
MU_MUST_USE mu_result mcap_writer_open(struct mcap_writer *w, const char *path,
                                       const char *library);

/**
 * Adds a channel.  Nothing of it is kept but in the file.
 *
 * @param index  out: for messages; channels count from 0
 * @return MU_OK; MU_FULL: MU_RECORD_CHANNELS_MAX, or the bytes of what describes them
 */
MU_MUST_USE mu_result mcap_writer_channel(struct mcap_writer *w, const struct mcap_channel *channel,
                                          uint32_t *index);

/**
 * Adds a message; its bytes are copied.
 *
 * @return MU_OK; MU_FULL: longer than MU_RECORD_MESSAGE_MAX, and counted; MU_FAULT_OS: the disk
 *         has failed before, or now
 */
mu_result mcap_writer_message(struct mcap_writer *w, const struct mcap_message *message);

/** Writes what is older than a second.  A writer that may be idle for longer calls it now and then.
 * @param now_ns  by the monotonic clock */
void mcap_writer_look(struct mcap_writer *w, uint64_t now_ns);

/** Adds a file of bytes: a world, a rule file.  @return as mcap_writer_message */
mu_result mcap_writer_attach(struct mcap_writer *w, const char *name, const char *media_type,
                             const void *bytes, size_t size);

/** Adds a file from the disk.  @return as mcap_writer_message; MU_ABSENT: it cannot be read */
mu_result mcap_writer_attach_file(struct mcap_writer *w, const char *name, const char *media_type,
                                  const char *path);

/** Adds a named table of keys and values.  @return as mcap_writer_message */
mu_result mcap_writer_metadata(struct mcap_writer *w, const char *name,
                               const struct mcap_pair *pairs, size_t count);

/** @return messages, bytes and files that were too long to be taken */
uint64_t mcap_writer_refused(const struct mcap_writer *w);

/** @return whether the disk has failed */
bool mcap_writer_failed(const struct mcap_writer *w);

/** Writes the summary and closes the file.  @return MU_OK; MU_FAULT_OS, said on standard error:
 * the file is not whole */
MU_MUST_USE mu_result mcap_writer_close(struct mcap_writer *w);

#endif
