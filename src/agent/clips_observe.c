/* SPDX-License-Identifier: Apache-2.0 */
/* A mind without a body: what it is told of a step, in facts that stand until the next one. */
#include "agent/clips_sense.h"

/* One that depends on another may go with it: the list is read anew each time. */
static void relations_clear(struct mind *m, const char *const *relations)
{
    for (; *relations; relations++) {
        const struct deftemplate *t = EnvFindDeftemplate(m->env, *relations);
        bool gone = true;
        while (t && t->factList && gone) {
            gone = EnvRetract(m->env, t->factList);
        }
    }
}

void mind_observe(struct mind *m, uint64_t time_ns, const char *const *relations)
{
    m->step++;
    if (CLIPS_BROKEN(m)) {
        return;
    }
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    m->percept.time_ns = time_ns;
    relations_clear(m, relations);
    clips_event_assert(m);
    clips_message_age(m);
    clips_env_leave(m);
}

mu_result mind_tell(struct mind *m, const char *fact)
{
    if (clips_text_check(fact) || CLIPS_BROKEN(m)) {
        return MU_MALFORMED;
    }
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    const struct fact *told = EnvAssertString(m->env, fact);
    bool failed = clips_env_leave(m);
    return told && !failed ? MU_OK : MU_MALFORMED;
}

bool mind_looks_at(const struct mind *m, const char *relation)
{
    const struct deftemplate *t = m->env ? EnvFindDeftemplate(m->env, relation) : NULL;
    return t && clips_sense_is_used(t);
}
