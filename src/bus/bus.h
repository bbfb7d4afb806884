/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file bus.h
 * The network under muster: Eclipse Cyclone DDS behind a dozen calls.
 *
 * Only src/bus sees the DDS headers.  Samples are the C types of idl/wire.idl.  One thread at a
 * time; no call waits but those that take a time, bus_wait and bus_drain.  The only listeners count
 * arrivals and matches: nothing is read or written from them.  Programs cannot tell which way a
 * sample came: by DDS, or between processes of one host by a socket (local.h).
 */
#ifndef MUSTER_BUS_BUS_H
#define MUSTER_BUS_BUS_H

#include "bus/cdr.h"
#include "core/text.h"
#include "muster/result.h"

#include <stdatomic.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define LOCAL_ENVIRONMENT "MUSTER_LOCAL"

/* Where a process stands in the star: the participant index that the others find it at. */
enum bus_place {
    BUS_BROKER,    /* the first free one of 0, 2, 3, 4; peers with all of its own host */
    BUS_SIMULATOR, /* index 1; likewise */
    BUS_AGENT,     /* a free index from 10 on; peers with brokers and simulator alone */
    BUS_OBSERVER,  /* the same; peers with the whole index range */
};

/* The topics; what they carry and how is the table in topics.c. */
enum bus_topic {
    BUS_REGISTRATION,
    BUS_UP,
    BUS_SENSE,
    BUS_DELIVERY,
    BUS_ROSTER,
    BUS_RUN_COMMAND,
    BUS_RUN_ANSWER,
    BUS_RUN_STATUS,
    BUS_PAGES,
    BUS_BROKER_STATUS,
    BUS_PART_STATUS,
    BUS_BROKER_EVENT,
    BUS_BEACON,
    BUS_SCENE,
    BUS_FRAME,
    BUS_TOPICS, /* how many */
};

/* The partition of circulars: no process can have that name. */
#define BUS_TO_ALL "to all"

/* A circular has so many letters at most, for so many boxes of one process. */
enum { BUS_CIRCULAR_LETTERS = 16, BUS_CIRCULAR_BOXES = 64 };

struct bus_options {
    int domain; /* DDS domain id, 0 to 230 */
    enum bus_place place;
    const char *name;      /* of the participant, for DDS tools */
    const char *interface; /* address of the network interface; NULL: 127.0.0.1 */
    const char *hub;       /* hosts of brokers and simulator, joined by commas; NULL: the
                              interface's own address, which hubs always peer with, too */
    const char *local;     /* "off": DDS alone; NULL: as LOCAL_ENVIRONMENT says, else "on" */
};

enum { BUS_BATCH = 32 };

/* The other sides of one endpoint that are looked at: all processes that a domain can have, and
 * their watchers. */
enum { BUS_ENDPOINTS_MAX = 1024 };

/* Writers of another version that a reader knows at most; of more, samples are read. */
enum { BUS_STRANGERS = 16 };

struct bus {
    int32_t domain; /* ours to close; 0: CYCLONEDDS_URI has made it */
    int32_t participant;
    enum bus_place place;
    int index;                     /* of the participant; -1: CYCLONEDDS_URI says */
    int32_t topics[BUS_TOPICS][2]; /* bare, and described (topics.h); 0: not opened yet */
    uint64_t malformed;            /* samples refused at the border */
    /* How many samples of DDS lie in the readers.  Counted by listeners, in threads of DDS. */
    _Atomic uint64_t arrived;    /* samples, ever */
    _Atomic uint64_t taken;      /* of them, no longer in a reader */
    _Atomic uint64_t wanted;     /* bus_wait wakes when so many are there; 0: no thread waits */
    _Atomic bool wakes;          /* a caller has asked for wake_fd: each arrival is news to it */
    uint64_t waited_ns;          /* when bus_wait last looked at the clock */
    uint64_t usual_ns;           /* for how long bus_wait has waited, on average */
    uint64_t rested_ns;          /* when it may stay awake again */
    uint64_t quiet_ns;           /* when nothing was there to read or write; 0: something was */
    bool wrote;                  /* a sample that sockets may take, since bus_wait */
    int poll_fd;                 /* an epoll of all that brings samples: */
    int note_fd;                 /* an eventfd that listeners write to, and sockets (local.h) */
    bool local;                  /* there may be sockets */
    uint64_t local_frames;       /* what has come by them and was not taken: samples, ends */
    uint64_t local_refused;      /* connections that did not come about */
    struct local_door *doors;    /* all readers with sockets */
    struct local_writer *locals; /* all writers with sockets */
    struct local_shared *shared; /* what those to one partition share; NULL: nothing */
    struct cdr_room room;        /* where a sample of such a topic is put together */
    _Atomic uint32_t matches;    /* how often DDS has matched, found or missed a reader of theirs */
};

struct bus_writer {
    struct bus *bus;
    enum bus_topic topic;
    int32_t writer;             /* 0: as `local` says */
    struct local_writer *local; /* NULL: DDS alone */
};

/* A reader takes a batch of samples and hands them out one at a time. */
struct bus_reader {
    struct bus *bus;
    enum bus_topic topic;
    int32_t reader;
    struct local_door *door;                /* NULL: DDS alone */
    uint32_t connected;                     /* writers, by sockets, now */
    _Atomic uint64_t arrived;               /* as in struct bus, of this reader, */
    uint64_t taken;                         /* likewise */
    uint64_t looked_ns;                     /* when it was last asked for samples */
    _Atomic uint32_t writers, writers_ever; /* that DDS has matched, now and ever */
    uint32_t met;                           /* of them, that were looked at (bus_reader_meets) */
    uint32_t strangers;
    uint64_t stranger[BUS_STRANGERS]; /* the next one replaces the oldest */
    int32_t count, next;              /* of the batch */
    uint32_t batches;                 /* since the samples were emptied */
    void *samples[BUS_BATCH];
    uint32_t states[BUS_BATCH];
    uint32_t fates[BUS_BATCH]; /* not BUS_DATA: that is to be said behind the sample */
};

/* What a sample says beside its data. */
enum bus_life {
    BUS_DATA,     /* the sample is whole */
    BUS_DISPOSED, /* its writer took the instance back: only the key means anything */
    BUS_LOST,     /* its writer is gone or silent: likewise */
};

/**
 * Creates the domain and the participant.
 *
 * The configuration is ours unless CYCLONEDDS_URI is set.  When it is ours and the interface is a
 * loopback address, the sockets are bound to that address and to no other.
 *
 * @return MU_OK; MU_BUSY when the place is taken (another simulator, or four brokers, are there);
 *         MU_FAULT_USAGE: no such address, more than MU_PEERS_MAX hosts, or this program is in
 *         that domain already; MU_FAULT_DDS
 */
MU_MUST_USE mu_result bus_open(struct bus *bus, const struct bus_options *options);

/** bus_open as the options of a program say. */
struct mu_network;
MU_MUST_USE mu_result bus_join(struct bus *bus, const struct mu_network *network,
                               enum bus_place place, const char *name);

/** Leaves the network; what was written and not yet sent is sent first.  The domain may be opened
 * again. */
void bus_close(struct bus *bus);

/** Opens a reader, which must stay where it is.  partition NULL: the default one. */
MU_MUST_USE mu_result bus_reader_open(struct bus *bus, enum bus_topic topic, const char *partition,
                                      struct bus_reader *reader);

/** The same for one that may fall far behind: it keeps the last `depth` samples of each instance
 * that have come and were not taken yet; 0: as many as the topic's writers do. */
MU_MUST_USE mu_result bus_reader_open_deep(struct bus *bus, enum bus_topic topic,
                                           const char *partition, int32_t depth,
                                           struct bus_reader *reader);

/** Closes a reader, if it is open; what lies in it counts as taken. */
void bus_reader_close(struct bus_reader *reader);

/** Opens a writer into one or two partitions; second may be NULL, first NULL is the default one. By
 * sockets readers of the first have a sample before those of the second, whose name must stay: a
 * process that is killed has told a broker what its simulator knows. */
MU_MUST_USE mu_result bus_writer_open(struct bus *bus, enum bus_topic topic, const char *first,
                                      const char *second, struct bus_writer *writer);

void bus_writer_close(struct bus_writer *writer);

/**
 * Says whether a broker can be the only one of its host: looks for the sockets of the others.
 *
 * @return whether no other of the brokers' indices of this host is taken
 */
bool bus_is_lone_broker(const struct bus *bus, int domain);

/** Writes one sample.  @return MU_OK; MU_BUSY: the network does not keep up, try again;
 * MU_FAULT_DDS */
MU_MUST_USE mu_result bus_write(const struct bus_writer *writer, const void *sample);

/** Takes an instance back; only the key of the sample is read. */
void bus_dispose(const struct bus_writer *writer, const void *sample);

/** @return whether a writer has found a reader that names this partition: not one that looks at all
 */
bool bus_writer_reaches(const struct bus_writer *writer, const char *partition);

/** @return whether the process that a writer has found in this partition reads what another writer
 * of ours writes, too */
bool bus_writer_shares(const struct bus_writer *writer, const char *partition,
                       const struct bus_writer *other);

/**
 * Says whether both directions to a process stand.
 *
 * @return whether the process that the writer reaches in its partition has a writer that this
 * reader has found; what such a writer sends before that comes a tenth of a second late
 */
bool bus_reader_hears(const struct bus_reader *reader, const struct bus_writer *writer,
                      const char *partition);

/** @return how many readers a writer has found */
uint32_t bus_writer_matches(const struct bus_writer *writer);

/** @return how many readers a writer has found since it was opened; those that are gone count, too
 */
uint32_t bus_writer_matched_ever(const struct bus_writer *writer);

/**
 * Looks at the writers that a reader of Registration or Beacon has found since the last call: their
 * types may be others under the same names, which DDS does not say.  Samples of those of another
 * version are not handed out.
 *
 * @param who  out: one of another version: "spin: muster 0.2.0 wire 3"
 * @return whether there is one; ask again
 */
bool bus_reader_meets(struct bus_reader *reader, char *who, size_t size);

/** @return whether bus_reader_meets has found that writer to be of another version */
bool bus_reader_is_stranger(const struct bus_reader *reader, uint64_t writer);

/** @return how many writers a reader has found; one that is there for any reader counts when it
 * writes here */
uint32_t bus_reader_matches(const struct bus_reader *reader);

/**
 * Hands out the next sample that is there.
 *
 * Samples that break a rule of the wire (check.h) are dropped here and counted in bus->malformed.
 * Every end of an instance is handed out, also of one that came and went between two looks: then
 * behind its last sample.
 *
 * @return the sample, on loan until the next bus_next of this reader; NULL: there is none now
 */
const void *bus_next(struct bus_reader *reader, enum bus_life *life);

/** @return memory for one sample of a topic, at start-up, for bus_keep */
void *bus_sample(enum bus_topic topic);

/**
 * Takes the sample that bus_next gave last out of its reader: it stays as it is, for the caller,
 * which does not hear of the end of its instance if that has come already.
 *
 * @param spare  memory of bus_sample, or of a sample kept earlier, that the reader gets for it
 * @return the sample
 */
void *bus_keep(struct bus_reader *reader, void *spare);

/**
 * Waits until samples lie in the readers, or the time is over.
 *
 * A caller that knows how many samples the next step needs is woken once instead of once each;
 * waking costs more than anything else in a step.
 *
 * @param samples     how many, in all readers together; 0: one more than lie there now
 * @param timeout_ns  at most so long, by the monotonic clock; < 0: 0.  With 0, after a write, it
 *                    does not look at sockets that had nothing in the last 20 us
 * @return whether that many lie there
 */
bool bus_wait(struct bus *bus, uint64_t samples, int64_t timeout_ns);

/**
 * Gives a file descriptor that is readable when samples have arrived since the last bus_wait.
 *
 * @return the bus's own; -1: the system has none left
 */
int bus_wake_fd(struct bus *bus);

/* The sides that the writers with sockets have found. */
struct bus_ways {
    uint64_t sockets, dds; /* that get their samples so, now */
    uint64_t refused;      /* connections that did not come about, ever: those are with DDS */
};

void bus_ways(const struct bus *bus, struct bus_ways *ways);

/** Waits until everything written has been acknowledged by its readers, or read from the socket:
 * they take it before what DDS brings later.  @return whether it has */
bool bus_drain(const struct bus_writer *writer, int64_t timeout_ns);

/** @return the version of DDS, "0.10.2" */
const char *bus_version(void);

/** @return the name of a topic on DDS */
const char *bus_topic_name(enum bus_topic topic);

/** Prints the table of topics as Markdown to standard output. */
void bus_print_topics(void);

/**
 * Says whether an interface's device is down: the system binds sockets to it all the same.
 *
 * @param interface  its IPv4 address; NULL: loopback
 * @param name       out, IFNAMSIZ bytes: the device's, if it is down
 */
bool bus_device_is_down(const char *interface, char *name);

/** @return the UDP port at which a participant index of a domain is found (RTPS 2.2, 9.6.1.1) */
int bus_port(int domain, int index);

#endif
