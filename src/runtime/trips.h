/* SPDX-License-Identifier: Apache-2.0 */
/**
 * @file trips.h
 * Words about agents that change their process, to and from the broker: docs/mobility.md.
 *
 * A word goes out with the next Up: with the answer to a step when it was said at its end, else at
 * once.
 */
#ifndef MUSTER_RUNTIME_TRIPS_H
#define MUSTER_RUNTIME_TRIPS_H

#include "muster/agent.h"
#include "wire.h"

enum { TRIPS_OUT_MAX = 2 * MU_CAPSULES_MAX };

struct trips_word {
    char agent[MU_NAME_MAX + 1], asker[MU_NAME_MAX + 1], host[MU_NAME_MAX + 1];
    char reason[MU_FIELD_MAX + 1];
};

struct trips {
    struct trips_word words[TRIPS_OUT_MAX];
    muster_Trip out[TRIPS_OUT_MAX];
    uint32_t count;
    bool prompt;    /* mail is not held for the next step: somebody may come at any time */
    bool under_way; /* nor now: an agent of the process is on its way */
    void *self;     /* of these; NULL: nobody */
    void (*on_trip)(void *self, const muster_Trip *trip);
    void (*on_step_end)(void *self); /* before it is answered: what is said goes with the answer, */
    void (*on_answered)(void *self); /* and after that */
};

/** Who hears the words that come, and of the ends of steps; mail is handed over as it comes. */
void trips_listen(mu_process *p, const struct trips *listener);

/**
 * Says something to the broker.
 *
 * @param trip  is copied, but for its text, which must stay until it is out
 * @return MU_OK, or MU_FULL: too many words wait
 */
MU_MUST_USE mu_result trips_say(mu_process *p, const muster_Trip *trip);

/** An agent of the process is on its way: what the broker says is not to wait for a step. */
void trips_set_under_way(mu_process *p, bool under_way);

/** Puts the words that wait into an Up.  @return whether there are any */
bool trips_fill(mu_process *p, muster_Up *up);

/** So many of them, the first, are out. */
void trips_sent(mu_process *p, uint32_t count);

/** @return how many bytes of text wait with the words that are not out */
size_t trips_bytes(const mu_process *p);

/** Hands over those that have come. */
void trips_take(mu_process *p, const muster_Delivery *d);

/** @return whether a step is to be expected soon */
bool trips_awaits_step(const mu_process *p);

/** @return whether the answer to a step has room for all that the agent has to say */
bool trips_fits_answer(const mu_agent *a);

/** @return whether all that the agent has said is out */
bool trips_all_sent(const mu_agent *a);

/** @return where the agent stands in its process, as in its registration */
uint32_t trips_slot(const mu_agent *a);

#endif
