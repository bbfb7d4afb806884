/* SPDX-License-Identifier: Apache-2.0 */
/* Events of the agent's life as facts: (event on-run), (event refused ...). */
#include "mind/facts/facts.h"

#include <string.h>

enum { EVENT_WORDS_MAX = 4 };

static const char *const event_names[MU_EVENTS] = {
    [MU_ON_CREATE] = "on-create", [MU_ON_RUN] = "on-run",     [MU_ON_ARRIVE] = "on-arrive",
    [MU_ON_LEAVE] = "on-leave",   [MU_ON_CLONE] = "on-clone", [MU_ON_DISPOSE] = "on-dispose"};

/* Asserts (event word...) anew; the fact stays until a rule retracts it. */
static void event_fact(struct mind *m, const char *const *words, size_t count, struct fact **fact)
{
    fact_retract(m, fact);
    EnvIncrementGCLocks(m->env); /* no garbage collection before the fields stand in a fact */
    struct multifield *fields = CreateMultifield2(m->env, (long)count);
    for (size_t i = 0; i < count; i++) {
        value_set_symbol(m->env, fields, i, words[i]);
    }
    *fact = fact_assert(m, inputs_of(m)->event, fields);
    EnvDecrementGCLocks(m->env);
}

/* A mind whose rules ignore events is the same on every host, to the numbers of its facts. */
static bool is_of_interest(const struct mind *m, size_t event)
{
    bool of_moves = event == MU_ON_ARRIVE || event == MU_ON_LEAVE;
    return !of_moves || inputs_of(m)->event->patternNetwork;
}

void events_assert(struct mind *m)
{
    for (size_t i = 0; i < MU_EVENTS; i++) {
        bool pending = inputs_of(m)->pending[i];
        inputs_of(m)->pending[i] = false;
        if (pending && is_of_interest(m, i)) {
            trace_cause(m, 'E', event_names[i], "");
            event_fact(m, &event_names[i], 1, &inputs_of(m)->events[i]);
        }
    }
}

static bool stands_on(const struct activation *a, const struct fact *fact)
{
    for (unsigned i = 0; i < a->basis->bcount; i++) {
        const struct alphaMatch *match = a->basis->binds[i].gm.theMatch;
        if (match && (const struct fact *)match->matchingItem == fact) {
            return true;
        }
    }
    return false;
}

bool events_are_awaited(struct mind *m, enum mu_event event)
{
    const struct fact *fact = inputs_of(m)->events[event];
    bool awaited = false;
    for (struct defmodule *d = NULL; fact && (d = environment_next_module(m, d));) {
        for (struct activation *a = EnvGetNextActivation(m->env, NULL); a && !awaited;
             a = EnvGetNextActivation(m->env, a)) {
            awaited = stands_on(a, fact);
        }
    }
    return awaited;
}

void events_refuse(struct mind *m, const char *change, const char *reason)
{
    char bytes[2 * (MU_FIELD_MAX + 1)];
    const char *words[EVENT_WORDS_MAX] = {"refused", bytes, reason};
    size_t count = 3;
    mu_text_copy(bytes, sizeof bytes, change);
    char *blank = strchr(bytes, ' ');
    if (blank) { /* the change, and its object */
        *blank = '\0';
        words[2] = blank + 1;
        words[count++] = reason;
    }
    event_fact(m, words, count, &inputs_of(m)->refused[inputs_of(m)->refused_next]);
    inputs_of(m)->refused_next = (inputs_of(m)->refused_next + 1) % EVENTS_REFUSED_MAX;
}
