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
 * Where DDS has the sample for others of its readers, too, one that is connected drops it.
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
    int fd;           /* -1: it is closed */
    uint64_t pair;    /* the last one of the bus's that it has brought a sample of, */
    uint32_t regular; /* and of how many before it, one after another */
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

/** @return what a reader has of the writer of that GUID; 0: it has not found it, or misses it */
dds_instance_handle_t bus_writer_find(const struct bus_reader *r, const dds_guid_t *writer);

/* --- local_pair.c --- */

/** Reads an answer, or writes what waits. */
void local_pair_ready(struct local_source *source, uint32_t events);

/* --- local_writer.c --- */

/** Closes what the bus's writers have not closed themselves. */
void local_writers_close(struct bus *bus);

/** Takes note of a writer whose topic has sockets.  @param last  the partition whose readers have a
 * sample last, which must stay; NULL: none */
void local_writer_open(struct bus *bus, enum bus_topic topic, const char *last,
                       struct bus_writer *w);

void local_writer_close(struct bus_writer *w);

/** Connects all writers to the readers that DDS has matched. */
void local_match(struct bus *bus);

/** @return how many readers DDS has matched, of which at most BUS_ENDPOINTS_MAX count */
uint32_t local_matches(struct local_writer *o);

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
