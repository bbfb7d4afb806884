/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file transfers.h
 * Words about agents that change their process, to and from the broker: docs/mobility.md.
 *
 * A word goes out with the next Up: with the answer to a step when it was said at its end, else at
 * once.
 */
#ifndef MUSTER_RUNTIME_TRANSFERS_H
#define MUSTER_RUNTIME_TRANSFERS_H

#include "muster/agent.h"
#include "wire.h"

enum { TRANSFERS_OUT_MAX = 2 * MU_CAPSULES_MAX };

struct transfer_word {
    char agent[MU_NAME_MAX + 1], asker[MU_NAME_MAX + 1], host[MU_NAME_MAX + 1];
    char reason[MU_FIELD_MAX + 1];
};

struct transfers {
    struct transfer_word words[TRANSFERS_OUT_MAX];
    muster_Trip out[TRANSFERS_OUT_MAX];
    uint32_t count;
    bool prompt;    /* mail never waits for the next step: an agent may come at any time */
    bool under_way; /* mail does not wait now: an agent of the process is on its way */
    void *self;     /* of these; NULL: none */
    void (*on_word)(void *self, const muster_Trip *word);
    void (*on_step_end)(void *self); /* before it is answered: words go with the answer, */
    void (*on_answered)(void *self); /* and after that */
};

/** Sets the handlers of words and of the ends of steps; mail is handed over as it comes. */
void transfers_listen(mu_process *p, const struct transfers *listener);

/**
 * Says something to the broker.
 *
 * @param word  is copied, but for its text, which must stay until it is out
 * @return MU_OK, or MU_FULL: too many words wait
 */
MU_MUST_USE mu_result transfers_say(mu_process *p, const muster_Trip *word);

/** An agent of the process is on its way: the broker's words do not wait for a step. */
void transfers_set_under_way(mu_process *p, bool under_way);

/** Puts the words that wait into an Up.  @return whether there are any */
bool transfers_fill(mu_process *p, muster_Up *up);

/** The first count words are out. */
void transfers_sent(mu_process *p, uint32_t count);

/** @return how many bytes of text wait with the words that are not out */
size_t transfers_bytes(const mu_process *p);

/** Hands over the words of a Delivery. */
void transfers_take(mu_process *p, const muster_Delivery *d);

/** @return whether a step is to be expected soon */
bool transfers_awaits_step(const mu_process *p);

/** @return whether the answer to a step has room for all that the agent has to say */
bool transfers_fits_answer(const mu_agent *a);

/** @return whether all that the agent has said is out */
bool transfers_all_sent(const mu_agent *a);

/** @return where the agent stands in its process, as in its registration */
uint32_t transfers_slot(const mu_agent *a);

#endif
