/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file tape.h
 * A recording of what taps hear: a channel for each topic, partition and quality of service, a
 * message for each sample, and beside it a channel of what instances have gone (bus/gone.h).
 */
#ifndef MUSTER_RECORD_TAPE_H
#define MUSTER_RECORD_TAPE_H

#include "bus/raw/raw.h"
#include "mcap/mcap.h"
#include "muster/limits.h"

enum { TAPE_WRITERS = 4096, TAPE_TYPE_MAX = TAP_NAME_MAX + 64 };

/* A channel of the file. */
struct tape_channel {
    const struct tap *tap;
    struct tap_offer offer;
    bool plain;                   /* in the first version of CDR, which definitions are for */
    bool gone;                    /* of what instances have gone */
    uint32_t sequence;            /* of the last message */
    char type[TAPE_TYPE_MAX + 1]; /* the attached file that describes the type; "": none */
};

/* Which channels a writer's samples go to, by the writer's handle: also of one that has gone. */
struct tape_writer {
    uint64_t writer;
    const struct tap *tap; /* NULL: free */
    uint32_t channel, gone_channel;
};

struct tape {
    struct mcap_writer *file;
    struct tape_channel channels[MU_RECORD_CHANNELS_MAX]; /* as in the file */
    uint32_t channel_count;
    struct tape_writer writers[TAPE_WRITERS];
    uint64_t messages, lost; /* lost: for want of a channel, or too long */
};

/** Takes the memory of a tape, at start-up. */
struct tape *tape_create(void);

/** Creates the file.  @return MU_OK or MU_FAULT_OS, said on standard error */
MU_MUST_USE mu_result tape_open(struct tape *t, const char *path, int domain);

/** A tap_taker: records a sample.  @param self  a struct tape */
void tape_take(void *self, struct tap *tap, const struct tap_sample *sample);

/** Writes what is older than a second.  @return whether the disk is in order */
bool tape_look(struct tape *t);

/** @return of how many topics it has samples */
size_t tape_topics(const struct tape *t);

/** Ends the file.  @return MU_OK or MU_FAULT_OS, said on standard error */
MU_MUST_USE mu_result tape_close(struct tape *t);

#endif
