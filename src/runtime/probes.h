/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file probes.h
 * Lines that only look (core/probe.h), asked and answered beside all mail: docs/lockstep.md.
 *
 * An answer goes out at once, in the middle of a lock step, too.  A question goes out like mail.
 */
#ifndef MUSTER_RUNTIME_PROBES_H
#define MUSTER_RUNTIME_PROBES_H

#include "muster/agent.h"
#include "wire.h"

/* How a probe ends. */
enum probe_end {
    PROBE_DONE = muster_GLANCE_DONE,         /* text is what the line shows */
    PROBE_FAILED = muster_GLANCE_FAILED,     /* text is why it shows nothing */
    PROBE_DECLINED = muster_GLANCE_DECLINED, /* no agent has looked, or may: the line can go as a
                                                 directive */
};

/* A question of this process, until it is answered. */
struct probes_asked {
    mu_agent *asker; /* NULL: free */
    uint64_t number;
    bool out; /* it has gone out */
    char agent[MU_NAME_MAX + 1];
    char line[MU_GLANCE_LINE_MAX + 1];
};

/* A question to this process, until an agent has looked. */
struct probes_due {
    uint64_t number;
    char asker[MU_NAME_MAX + 1], agent[MU_NAME_MAX + 1];
    char line[MU_GLANCE_LINE_MAX + 1];
};

struct probes {
    struct probes_asked asked[MU_GLANCES_EACH];
    uint32_t count, unsent;
    uint64_t numbers;                      /* given so far */
    uint64_t incarnation;                  /* of the broker that they went to */
    struct probes_due due[MU_GLANCES_MAX]; /* a ring: as many as the broker has under way */
    uint32_t due_first, due_count;
    muster_Glance out[MU_GLANCES_EACH]; /* in the Up at hand */
};

/* An agent's handlers of probes and of their answers. */
struct probes_handlers {
    /* Looks.  @return its end; text: the answer, which stays until the next call */
    enum probe_end (*look)(void *self, const char *line, const char **text);
    /* A question of this agent's has its end. */
    void (*on_end)(void *self, uint64_t number, enum probe_end end, const char *text);
    void *on_end_self;
};

/** Lets an agent answer probes; look gets the self of its handlers. */
void probes_answer(mu_agent *a,
                   enum probe_end (*look)(void *self, const char *line, const char **text));

/** Lets an agent hear how its own probes end. */
void probes_hear(mu_agent *a,
                 void (*on_end)(void *self, uint64_t number, enum probe_end end, const char *text),
                 void *self);

/**
 * Asks; every question has one end, unless the broker loses it.
 *
 * @param number  out: of the question
 * @return MU_OK; MU_REFUSED: the line does not only look, that is no name, or the process lives in
 *         steps itself;
 *         MU_FULL: MU_GLANCES_EACH have no end yet
 */
MU_MUST_USE mu_result probes_ask(mu_agent *a, const char *agent, const char *line,
                                 uint64_t *number);

/** Keeps the questions of a Delivery, and hands over the answers in it. */
void probes_take(mu_process *p, const muster_Delivery *d);

/** Between two steps: answers the questions that were kept, as far as the network takes it. */
void probes_look(mu_process *p);

/** Puts the questions that wait into an Up.  @return whether there are any */
bool probes_fill(mu_process *p, muster_Up *up);

/** An Up is out: the questions in it are, too. */
void probes_sent(mu_process *p, const muster_Up *up);

/** Declines the questions that went to an earlier broker. */
void probes_review(mu_process *p);

/** Of an agent that leaves nothing is asked any more. */
void probes_forget(mu_agent *a);

#endif
