/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file local_pair.h
 * A writer and one of its readers, of another process of this host (local.h).
 */
#ifndef MUSTER_BUS_LOCAL_PAIR_H
#define MUSTER_BUS_LOCAL_PAIR_H

#include "bus/local.h"

/* What a reader does not take is kept, up to so much: then it is the writer that waits.
 * As what DDS keeps of a process (config.c). */
enum { LOCAL_WAITING_MAX = 8 << 20 };

enum pair_state {
    PAIR_ASKED,  /* it is connected, and has no answer yet */
    PAIR_OPEN,   /* samples go by the socket */
    PAIR_ENDED,  /* the reader has closed it, and DDS will miss it soon */
    PAIR_LEAVES, /* it was asked in vain, and samples wait until DDS serves it */
    PAIR_ON_DDS,
};

/* What DDS has matched the reader with. */
enum pair_match {
    PAIR_FOUND,  /* the writer that is shared (local_shared.h) */
    PAIR_SERVED, /* the writer itself */
};

/* A writer and one of its readers. */
struct local_pair {
    struct local_source source;
    struct local_pair *next;
    struct local_writer *writer;
    dds_instance_handle_t reader; /* on DDS */
    dds_guid_t process;           /* the reader's */
    enum pair_state state;
    enum pair_match match;
    uint32_t met;          /* of the writer's `seen`, when DDS last had it */
    bool last;             /* behind all those that are not */
    bool named;            /* it names the partition that the writer shares one for: no pattern */
    uint64_t asked_ns;     /* since when a sample waits for the answer; 0: none does */
    char *waiting;         /* what the kernel did not take */
    size_t size, from, to; /* of waiting, and what is in it */
    size_t begun;          /* up to here it is the rest of one whose beginning is out */
};

struct local_writer {
    struct bus *bus;
    struct local_writer *next; /* of the bus */
    enum bus_topic topic;
    const char *last;    /* the partition of readers that are last; NULL: none */
    char *partition;     /* what it shares the bus's writer for; NULL: it shares nothing */
    dds_entity_t writer; /* 0: it is not on DDS */
    uint32_t seen;       /* of bus->matches, when it last looked */
    uint32_t ever;       /* how many readers it has found, and how many DDS serves */
    bool stale;          /* of one that shares: its readers may be others than those it has */
    dds_time_t stamp;
    struct local_pair *pairs;
};

/** Asks a reader for a socket.  One without a socket, of another host or another user stays with
 * DDS.  A reader that the shared writer has found hears that all comes so which the process writes
 * to it: nothing else of the process does. */
void local_pair_ask(struct local_pair *p, const dds_builtintopic_endpoint_t *reader);

/** Leaves a reader that was asked to DDS. */
void local_pair_leave(struct local_pair *p);

/** Writes a frame, or keeps what the kernel does not take. */
void local_pair_write(struct local_pair *p, const char *frame, size_t size);

/** Writes what waits, as far as the kernel takes it. */
void local_pair_send(struct local_pair *p);

void local_pair_close(struct local_pair *p, enum pair_state state);

#endif
