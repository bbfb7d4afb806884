/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file tap.h
 * Topics as bytes: for who records samples without looking into them, of our topics and of any.
 *
 * A tap is a reader of one topic in every partition.  It asks for what the writers offer, so that a
 * reliable writer is read reliably; it keeps the last TAP_DEPTH samples of an instance until they
 * are taken.
 */
#ifndef MUSTER_BUS_TAP_H
#define MUSTER_BUS_TAP_H

#include "bus/bus.h"
#include "bus/gone.h"

enum { TAP_NAME_MAX = 255, TAP_DEPTH = 8192, TAP_BATCH = 256 };

/* Partitions of one writer, and what one offers, in bytes. */
enum { TAP_PARTITIONS_MAX = 1023, TAP_OFFER_MAX = 511 };

struct tap {
    char name[TAP_NAME_MAX + 1]; /* of the topic */
    char type[TAP_NAME_MAX + 1]; /* as on DDS: "muster::Frame" */
    int32_t topic, reader;       /* 0: not open */
    bool reliable, durable;      /* what the reader asks for: no more than each writer offers */
    bool exclusive;              /* instances belong to their strongest writers: these alone */
    bool ours;                   /* the topic is in our table */
    uint64_t retry_ns;           /* not open: when to try again, by the monotonic clock */
};

/* One sample of a tap, or that an instance has gone. */
struct tap_sample {
    enum gone_what gone; /* not GONE_NOT: data is the key of the instance */
    const void *data; /* with the four bytes of its encapsulation; good until the taker returns */
    size_t size;
    uint64_t source_ns; /* when it was written, by its writer's clock, since 1970 */
    uint64_t writer;    /* which one wrote it: for tap_offer */
};

/* What a writer offers to readers. */
struct tap_offer {
    char partitions[TAP_PARTITIONS_MAX + 1]; /* the names, a line each; "": the default one */
    char words[TAP_OFFER_MAX + 1];           /* its quality of service (offer.h); "" of ours */
};

typedef void tap_taker(void *self, struct tap *tap, const struct tap_sample *sample);

/* Who is asked for what there is on the network. */
struct tap_watch {
    struct bus *bus;
    int32_t publications, subscriptions;
    uint64_t looked_ns; /* when all were looked at last, not the new ones alone */
};

/** Opens a tap of one of our topics, before there is anybody.  @return MU_OK or MU_FAULT_DDS */
MU_MUST_USE mu_result tap_open(struct tap *tap, struct bus *bus, enum bus_topic topic);

/** Looks for topics from now on. */
MU_MUST_USE mu_result tap_watch_open(struct tap_watch *watch, struct bus *bus);

/**
 * Opens taps for topics that have writers and no tap yet, and has those that ask for too much ask
 * for less.  Our topics are known by name; the types of others are asked for, which takes up to
 * 200 ms each, and is tried again while it fails.
 *
 * @param taps    in, out: one for each topic that has been seen, open or not
 * @param wanted  whether a topic is wanted; NULL: all are
 * @return how many there are now, at most max
 */
size_t tap_watch_look(struct tap_watch *watch, struct tap *taps, size_t count, size_t max,
                      bool (*wanted)(const char *topic));

/**
 * Hands out the samples that are there, those of one batch in the order in which they were written:
 * DDS itself puts the samples of an instance together.
 *
 * So, too, that an instance was disposed, or has no writers any more: once each time, between the
 * samples before and those after it.  Where several things became of it between two calls, when it
 * was that it had gone is not known, and is taken to be when the sample before it was written.
 *
 * @return how many samples; 0: none is there now
 */
size_t tap_take(struct tap *tap, tap_taker *take, void *self);

/** Finds what a writer of a tap offers.  @return false: it is gone; the offer is empty */
bool tap_offer(const struct tap *tap, uint64_t writer, struct tap_offer *offer);

/** Writes what the type looks like, as bus_schema; MU_ABSENT, MU_REFUSED: it cannot be said. */
mu_result tap_schema(const struct tap *tap, struct mu_text *name, struct mu_text *text);

/**
 * Writes the type of a topic that is not ours as bytes, for feed_open_foreign.
 *
 * @param name  out: "zoo::Animal-HASH", the same for the same type alone
 * @return how many bytes; 0: it does not describe itself, or there is no room
 */
size_t tap_type(const struct tap *tap, void *to, size_t size, struct mu_text *name);

/** Writes the quality of service that the topic's writers offer, as rosbag2 does in its files. */
void tap_profile(const struct tap *tap, const struct tap_offer *offer, struct mu_text *text);

#endif
