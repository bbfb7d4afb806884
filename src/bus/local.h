/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file local.h
 * Samples between processes of one host, through stream sockets of the kernel's beside DDS.
 *
 * DDS finds, matches and misses all processes, and serves other hosts and tools.  A reader of mail
 * or steps listens on a socket without a file, whose random name stands in its discovery data; a
 * writer that DDS has matched with it connects.  Such a socket of another host or of another
 * network namespace is not to be found, and a peer of another user is refused: then the pair stays
 * with DDS.  The way of a pair is settled before the first sample to it, and holds as long as DDS
 * has it matched.
 *
 * The writer says first who it is on DDS; the reader answers with one byte; the writer says from
 * when on all comes here, and then samples come, as frames (cdr.h) in the byte order of the host.
 * Where DDS has the sample for others of its readers, too, one that is connected drops it.  One
 * writer finds the readers of many partitions (local_shared.h).
 *
 * One thread at a time.  Memory is DDS's, like that of its samples.
 */
#ifndef MUSTER_BUS_LOCAL_H
#define MUSTER_BUS_LOCAL_H

#include "bus/bus.h"

#include <dds/dds.h>

/* What a descriptor of the bus's epoll belongs to: the first member of a connection. */
struct local_source {
    enum { LOCAL_DOOR, LOCAL_INPUT, LOCAL_OUTPUT } kind;
    int fd; /* -1: it is closed */
};

/* --- local_reader.c --- */

/** Makes the socket of a reader that is about to be opened, if its topic has one, and puts its name
 * into the quality of service. */
void local_reader_open(struct bus_reader *r, dds_qos_t *qos);

void local_reader_close(struct bus_reader *r);

/** Closes what the bus's readers have not closed themselves. */
void local_readers_close(struct bus *bus);

/** Reads a socket of a reader that has something. */
void local_reader_ready(struct bus *bus, struct local_source *source);

/** Decodes what has come by sockets.  @return how many samples and ends the reader got */
int32_t local_take(struct bus_reader *r);

/** @return whether a sample of DDS comes, or came, by a socket, too */
bool local_has(struct bus_reader *r, const dds_sample_info_t *info);

/* --- bus_matches.c --- */

/** Finds out what a writer and its participant are on DDS.  @return false: the reader misses it, or
 * it only finds readers (local_shared.h) */
bool bus_writer_identify(const struct bus_reader *r, dds_instance_handle_t writer,
                         dds_guid_t who[2]);

/* --- local_pair.c --- */

/** Reads an answer, or writes what waits. */
void local_pair_ready(struct local_source *source, uint32_t events);

/* --- local_writer.c --- */

/** Closes what the bus's writers have not closed themselves. */
void local_writers_close(struct bus *bus);

/** Takes note of a writer on DDS, if its topic has sockets.  A process that writes to all of a
 * topic writes to many partitions: those of them that are opened later share a second writer.
 *
 * @param first  its partition
 * @param last   the partition whose readers have a sample last, which must stay; NULL: none */
void local_writer_open(struct bus_writer *w, const char *first, const char *last);

/** Opens a writer to a partition that is not on DDS before a reader needs that (local_shared.h).
 * @return whether there is one to share */
bool local_writer_share(struct bus_writer *w, const char *partition);

/** Closes a writer with sockets, if it is one. */
void local_writer_close(struct bus_writer *w);

/** Connects all writers to the readers that DDS has matched. */
void local_match(struct bus *bus);

/** @return how many readers DDS has matched, of which at most BUS_ENDPOINTS_MAX count */
uint32_t local_matches(struct local_writer *o);

/** @return a number that is higher when it has matched more of them than before */
uint32_t local_matched_ever(struct local_writer *o);

/** Finds the process that reads the partition of one that shares.  @return whether there is one */
bool local_process_find(struct local_writer *o, const char *partition, dds_guid_t *process);

/** @return the writer on DDS; 0: there is none */
dds_entity_t local_on_dds(const struct local_writer *o);

/** @return whether a sample can be written now: all pairs are settled, and take more */
bool local_has_room(struct local_writer *o);

/** @return whether a reader gets its samples by DDS */
bool local_needs_dds(const struct local_writer *o);

/** Writes a sample to all that are connected (cdr.h). */
void local_write(struct local_writer *o, const char *frame);

/** @return a time for the next sample on DDS, later than those of all before */
dds_time_t local_stamp(struct local_writer *o);

/** @return whether all readers with sockets have read what was written */
bool local_is_out(const struct local_writer *o);

#endif
