/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file channels.h
 * Which channels of a recording are replayed, and to what.
 *
 * Ours are replayed to programs that look at runs; topics of other programs as they were.  What is
 * left out and might have been expected is said on standard error, with the reason.
 */
#ifndef MUSTER_REPLAY_CHANNELS_H
#define MUSTER_REPLAY_CHANNELS_H

#include "bus/raw/raw.h"
#include "core/options.h"
#include "mcap/mcap.h"
#include "muster/limits.h"

struct channels {
    struct bus *bus;
    struct mcap_reader *file;
    const struct mu_option_list *topics;        /* those that are wanted; none: the usual ones */
    struct feed *feeds[MU_RECORD_CHANNELS_MAX]; /* of the file's channels; NULL: left out */
    bool gone[MU_RECORD_CHANNELS_MAX];          /* it says what instances have gone */
    size_t count;                               /* of those that are replayed */
};

/**
 * Opens a feed for each channel that is replayed, at start-up, and picks these channels of the
 * file.
 *
 * @return MU_OK, also when none is; MU_FAULT_DDS
 */
MU_MUST_USE mu_result channels_open(struct channels *c);

/** Writes a message to its feed.  @return as feed_write */
MU_MUST_USE mu_result channels_write(struct channels *c, const struct mcap_message *m);

#endif
