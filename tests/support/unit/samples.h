/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file samples.h
 * Samples of the wire as tests write them, and the words by which tests read them.
 */
#ifndef MUSTER_TESTS_SAMPLES_H
#define MUSTER_TESTS_SAMPLES_H

#include "wire.h"

#include <stdint.h>

/** idlc makes no const members; nobody writes there.  @return s, which must stay */
static inline char *words(const char *s)
{
    return (char *)(uintptr_t)s;
}

/** @return a mail of rules to rules, with pointers to the texts that were given */
static inline muster_Mail letter(const char *src, uint64_t seq, const char *dst,
                                 const char *content)
{
    return (muster_Mail){.src = words(src),
                         .seq = seq,
                         .dst = words(dst),
                         .layer = 3,
                         .performative = words("tell"),
                         .language = words(""),
                         .ontology = words(""),
                         .reply_with = words(""),
                         .in_reply_to = words(""),
                         .conversation = words(""),
                         .due_ns = -1,
                         .content = words(content)};
}

/* An Up in which one agent speaks. */
struct one_up {
    muster_Act act;
    muster_Ack ack;
    muster_Up up;
};

/**
 * Fills in what an agent that runs says at once.  What it points to must stay.
 *
 * @param mails  count of them
 * @param ack    the number up to which it has taken parcels; 0: none
 */
static inline void one_up(struct one_up *u, const char *agent, const char *process,
                          muster_Mail *mails, uint32_t count, uint64_t ack)
{
    *u = (struct one_up){.act = {.agent = words(agent),
                                 .state = muster_STATE_RUNNING,
                                 .rules = words(""),
                                 .diary = words("")},
                         .ack = {.box = words(agent), .number = ack},
                         .up = {.process = words(process), .step = muster_STEP_NOW}};
    u->act.mails = (dds_sequence_muster_Mail){._length = count, ._buffer = mails};
    u->up.acts = (dds_sequence_muster_Act){._length = 1, ._buffer = &u->act};
    u->up.acks = (dds_sequence_muster_Ack){._length = ack > 0, ._buffer = &u->ack};
}

static inline const char *outcome_word(muster_Outcome o)
{
    static const char *const all[] = {"delivered", "stored",  "expired", "box-full", "unknown-name",
                                      "duplicate", "refused", "dropped", "no-store"};
    return all[o];
}

static inline const char *state_word(muster_State s)
{
    static const char *const all[] = {"standby", "running", "suspended", "moving", "absent"};
    return all[s];
}

static inline const char *glance_word(muster_GlanceWord w)
{
    static const char *const all[] = {"asks", "done", "failed", "declined"};
    return all[w];
}

static inline const char *trip_word(muster_TripWord w)
{
    static const char *const all[] = {"deposit", "arrive", "ready", "refused",
                                      "taken",   "stored", "wanted"};
    return all[w];
}

#endif
