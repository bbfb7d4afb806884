/* SPDX-License-Identifier: Apache-2.0 */
/* A mind without a body: what it is told of a step, in facts that stand until the next one. */
#include "mind/facts/facts.h"

#include <string.h>

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

/* Looks on from the slot behind the last one that was found.
 * @return index of the slot, or -1 */
static long slot_find(const struct deftemplate *t, const char *name, long from)
{
    for (int round = 0; round < 2; round++) {
        long at = 0;
        for (const struct templateSlot *s = t->slotList; s; s = s->next, at++) {
            if (at >= from && strcmp(ValueToString(s->slotName), name) == 0) {
                return s->multislot ? -1 : at;
            }
        }
        from = 0;
    }
    return -1;
}

static void slot_fill(void *env, struct field *to, const struct mind_slot *slot)
{
    switch (slot->kind) {
    case MIND_SLOT_SYMBOL:
    case MIND_SLOT_STRING:
        to->type = slot->kind == MIND_SLOT_SYMBOL ? SYMBOL : STRING;
        to->value = EnvAddSymbol(env, slot->word);
        break;
    case MIND_SLOT_REAL:
        to->type = FLOAT;
        to->value = EnvAddDouble(env, slot->real);
        break;
    case MIND_SLOT_COUNT:
        to->type = INTEGER;
        to->value = EnvAddLong(env, (long long)slot->count);
        break;
    }
}

/* @return the fact, asserted; NULL: it has not got such a slot, or is there already */
static struct fact *slots_assert(void *env, struct deftemplate *t, const struct mind_slot *slots,
                                 size_t count)
{
    long at = -1;
    struct fact *f = EnvCreateFact(env, t);
    for (size_t i = 0; i < count; i++) {
        at = slot_find(t, slots[i].name, at + 1);
        if (at < 0) {
            ReturnFact(env, f);
            return NULL;
        }
        slot_fill(env, &f->theProposition.theFields[at], &slots[i]);
    }
    EnvAssignFactSlotDefaults(env, f);
    return EnvAssert(env, f);
}

mu_result mind_tell_slots(struct mind *m, const char *relation, const struct mind_slot *slots,
                          size_t count)
{
    if (CLIPS_BROKEN(m)) {
        return MU_MALFORMED;
    }
    clips_env_enter(m, CLIPS_MODE_QUIET);
    clips_guard_start(m, 0);
    struct deftemplate *t = EnvFindDeftemplate(m->env, relation);
    bool whole = t && !t->implied && slots_assert(m->env, t, slots, count) != NULL;
    bool failed = clips_env_leave(m);
    return whole && !failed ? MU_OK : MU_MALFORMED;
}

bool mind_looks_at(const struct mind *m, const char *relation)
{
    const struct deftemplate *t = m->env ? EnvFindDeftemplate(m->env, relation) : NULL;
    return t && fact_is_used(t);
}
