/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file schedule.h
 * Mails in order of a time: when they are due, or when they expire.
 */
#ifndef MUSTER_BROKER_SCHEDULE_H
#define MUSTER_BROKER_SCHEDULE_H

#include "broker/base/store.h"

struct schedule {
    struct mail **heap; /* SHARE_MAILS_MAX of them: a mail stands here once */
    uint32_t count;
    enum schedule_kind kind;
};

void schedule_init(struct schedule *s, enum schedule_kind kind);

/** Enters a mail for m->at_ns of this kind; equal times go by m->order. */
void schedule_add(struct schedule *s, struct mail *m);

/** Takes a mail out, if it is in. */
void schedule_remove(struct schedule *s, struct mail *m);

/** @return the earliest mail, or NULL */
struct mail *schedule_first(const struct schedule *s);

#endif
