/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file boxroom.h
 * Whether a box has room for a mail, and what has to go if not.
 *
 * A sender has a fair share of each box (share.h).  Where the box drops mail when it is full,
 * whoever is over its share makes room with its own mail, so that a flood costs nobody else
 * anything; only a box that is full of fair shares drops the mail of others.
 *
 * Only ordinary mail that waits is dropped: never what is in flight, held for a time, or a
 * directive.
 */
#ifndef MUSTER_BROKER_BOXROOM_H
#define MUSTER_BROKER_BOXROOM_H

#include "broker/base/mailbox.h"

enum boxroom {
    BOXROOM_FITS,
    BOXROOM_DROP, /* another mail has to go first; then ask again */
    BOXROOM_FULL,
    BOXROOM_OVER_SHARE
};

/**
 * Says whether a mail may be put into a box.
 *
 * @param victim  out, with BOXROOM_DROP: the post that has to go
 */
enum boxroom boxroom_ask(struct mailbox *m, uint32_t agent, const struct mail *mail,
                         uint32_t *victim);

#endif
