/* SPDX-License-Identifier: Apache-2.0 */
/* What happens in the agent's life, as facts: (event on-run), (event refused ...). */
#include "agent/clips_mind.h"
#include "agent/clips_value.h"

#include <string.h>

enum { EVENT_WORDS_MAX = 4 };

static const char *const event_names[MU_EVENTS] = {
    [MU_ON_CREATE] = "on-create", [MU_ON_RUN] = "on-run",     [MU_ON_ARRIVE] = "on-arrive",
    [MU_ON_LEAVE] = "on-leave",   [MU_ON_CLONE] = "on-clone", [MU_ON_DISPOSE] = "on-dispose"};

/* Asserts (event word...) anew; it stays until a rule retracts it. */
static void event_fact(struct mind *m, const char *const *words, size_t count, struct fact **fact)
{
    clips_percept_retract(m, fact);
    EnvIncrementGCLocks(m->env); /* nothing built here may go before it stands in a fact */
    struct multifield *fields = CreateMultifield2(m->env, (long)count);
    for (size_t i = 0; i < count; i++) {
        clips_value_set_symbol(m->env, fields, i, words[i]);
    }
    *fact = clips_percept_assert(m, m->event, fields);
    EnvDecrementGCLocks(m->env);
}

void clips_event_assert(struct mind *m)
{
    for (size_t i = 0; i < MU_EVENTS; i++) {
        if (m->pending[i]) {
            m->pending[i] = false;
            clips_diary_cause(m, 'E', event_names[i], "");
            event_fact(m, &event_names[i], 1, &m->events[i]);
        }
    }
}

void mind_event(struct mind *m, enum mu_event event)
{
    m->pending[event] = true;
}

void mind_event_now(struct mind *m, enum mu_event event, struct mind_act *act)
{
    m->pending[event] = true;
    if (!CLIPS_BROKEN(m)) {
        clips_env_enter(m, CLIPS_MODE_QUIET);
        clips_guard_start(m, 0);
        clips_event_assert(m);
        clips_env_leave(m);
    }
    mind_fire(m, act);
}

void mind_refused(struct mind *m, const char *change, const char *reason)
{
    char bytes[2 * (MU_FIELD_MAX + 1)];
    const char *words[EVENT_WORDS_MAX] = {"refused", bytes, reason};
    size_t count = 3;
    if (CLIPS_BROKEN(m)) {
        return;
    }
    mu_text_copy(bytes, sizeof bytes, change);
    char *blank = strchr(bytes, ' ');
    if (blank) { /* which change, and of what */
        *blank = '\0';
        words[2] = blank + 1;
        words[count++] = reason;
    }
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    event_fact(m, words, count, &m->refused[m->refused_next]);
    m->refused_next = (m->refused_next + 1) % CLIPS_REFUSED_MAX;
    clips_env_leave(m);
}
