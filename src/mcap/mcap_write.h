/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file mcap_write.h
 * Writes a recording: one MCAP file with uncompressed chunks, indices, checksums and a summary.
 *
 * What is written is on its way to the disk at the latest a second later, or when a megabyte has
 * come together; a file whose writer was killed can be read up to there.  All memory is taken once;
 * the summary is made from the file itself, so that a recording may be as long as the disk allows.
 *
 * An error of the disk is kept: from then on nothing is written, and the close tells.
 */
#ifndef MUSTER_MCAP_MCAP_WRITE_H
#define MUSTER_MCAP_MCAP_WRITE_H

#include "mcap/mcap_channel.h"
#include "muster/result.h"

#include <stdbool.h>

struct mcap_writer;

/** Takes the memory of a writer, at start-up. */
struct mcap_writer *mcap_writer_create(void);

/**
 * Creates the file, or empties it, and writes its head.
 *
 * @param library  who writes, for people: "muster 0.1.0"
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

/** Writes what is older than a second.  Who may be idle for longer calls it now and then.
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
