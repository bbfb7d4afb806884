/* SPDX-License-Identifier: Apache-2.0 */
/* A step: the inputs of a mind, and the firing of its rules. */
#include "mind/mind.h"
#include "mind/snapshot/snapshot.h"

#include <stdio.h>
#include <string.h>

/* Fires rules until one errs, the step ends, or the budget is used. */
static uint32_t fire_some(struct mind *m, uint32_t budget, bool *failed)
{
    environment_begin(m);
    long long fired = EnvRun(m->env, budget);
    bool halted = GetHaltExecution(m->env); /* EnvRun itself clears the other flag */
    (void)environment_end(m);
    *failed = halted;
    if (halted) {
        failures_note(m);
    }
    if (m->said.len > 0 || halted) {
        complaint_show(m, "rule", m->rule ? m->rule : "?");
    }
    return (uint32_t)fired;
}

static enum mind_end fire_loop(struct mind *m, uint32_t budget)
{
    while (output_of(m)->act.firings < budget) {
        bool failed;
        if (lifecycle_stops(m)) {
            output_of(m)->act.why = output_of(m)->stands;
            return MIND_BREAK;
        }
        uint32_t fired = fire_some(m, budget - output_of(m)->act.firings, &failed);
        output_of(m)->act.firings += fired;
        output_of(m)->act.errors += failed;
        if (m->stopped) {
            output_of(m)->act.why = m->stopped;
            return MIND_STOPPED;
        }
        if (output_of(m)->sense_again || output_of(m)->travel.kind != MIND_STAYS) {
            return MIND_SENSE_AGAIN;
        }
        bool idle = !failed && output_of(m)->act.firings < budget && !lifecycle_breaks(m);
        if (fired == 0 || idle) {
            return MIND_IDLE;
        }
    }
    return EnvGetNextActivation(m->env, NULL) ? MIND_BUDGET : MIND_IDLE;
}

void mind_fire(struct mind *m, struct mind_act *act)
{
    mind_fire_some(m, m->options.firings_max, act);
}

/* The act of a failed mind: no rule fires, and the robot stands still. */
static void fire_nothing(struct mind *m, struct mind_act *act)
{
    snprintf(m->reason, sizeof m->reason, "its rules are gone: %s", m->failed_by);
    *act = (struct mind_act){.drives = true,
                             .errors = 1,
                             .rules = "",
                             .end = MIND_STOPPED,
                             .why = m->failed_by,
                             .enough = m->reason};
}

void mind_fire_some(struct mind *m, uint32_t most, struct mind_act *act)
{
    if (!MIND_ENTER(m, STATE_FIRE)) {
        fire_nothing(m, act);
        return;
    }
    uint32_t budget = most < m->options.firings_max ? most : m->options.firings_max;
    mu_text_clear(&m->fired);
    m->printed = 0;
    output_of(m)->sense_again = false;
    m->rule = NULL;
    output_of(m)->act.end = fire_loop(m, budget);
    output_of(m)->act.enough = m->enough ? m->reason : NULL;
    m->enough = false;
    output_of(m)->act.rules = m->fired.at;
    trace_agenda(m);
    (void)mind_leave(m);
    prefetch_end(m);
    *act = output_of(m)->act;
    output_of(m)->act = (struct mind_act){.drives = false};
}

/* percept NULL: there is none at this time. */
static void percept_sense(struct mind *m, const struct mu_percept *percept, uint64_t time_ns)
{
    inputs_of(m)->step++;
    if (!MIND_ENTER(m, STATE_SENSE)) {
        return;
    }
    (void)prefetch_begin(m);
    EnvIncrementGCLocks(m->env); /* no garbage collection before the fields stand in a fact */
    trace_cause(m, 'S', "", "");
    if (percept) {
        percept_take(m, percept);
    } else {
        percept_lose(m, time_ns);
    }
    events_assert(m);
    messages_age(m);
    EnvDecrementGCLocks(m->env);
    (void)mind_leave(m);
}

void mind_percept(struct mind *m, const struct mu_percept *percept)
{
    percept_sense(m, percept, 0);
}

void mind_feel_nothing(struct mind *m, uint64_t time_ns)
{
    percept_sense(m, NULL, time_ns);
}

void mind_event(struct mind *m, enum mu_event event)
{
    inputs_of(m)->pending[event] = true;
}

void mind_event_now(struct mind *m, enum mu_event event, struct mind_act *act)
{
    volatile bool awaited = false; /* volatile: MIND_ENTER may return twice */
    *act = (struct mind_act){.rules = "", .end = MIND_IDLE};
    inputs_of(m)->pending[event] = true;
    if (MIND_ENTER(m, STATE_SENSE)) {
        events_assert(m);
        awaited = events_are_awaited(m, event);
        (void)mind_leave(m);
    }
    if (awaited) {
        mind_fire(m, act);
    }
}

void mind_mail_returned(struct mind *m, const char *verb, const char *to, const char *outcome)
{
    char what[2 * (MU_FIELD_MAX + 1)];
    if (!state_has_rules(m) || !inputs_of(m)->event->patternNetwork) {
        return;
    }
    struct mu_text t = mu_text_in(what, sizeof what);
    mu_text_format(&t, "%s %s", verb, to);
    mind_refused(m, what, outcome);
}

void mind_refused(struct mind *m, const char *change, const char *reason)
{
    if (!MIND_ENTER(m, STATE_SENSE)) {
        return;
    }
    events_refuse(m, change, reason);
    (void)mind_leave(m);
}

mu_result mind_take_mail(struct mind *m, const struct mind_mail *mail)
{
    if (!MIND_ENTER(m, STATE_TAKE)) {
        return MU_FULL;
    }
    trace_mail(m, mail);
    mu_result r = mailbox_take(m, mail);
    (void)mind_leave(m);
    return r;
}

/* A fact that depends on another may go with it, so the list is read anew each time. */
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
    inputs_of(m)->step++;
    if (!MIND_ENTER(m, STATE_SENSE)) {
        return;
    }
    inputs_of(m)->percept.time_ns = time_ns;
    relations_clear(m, relations);
    events_assert(m);
    messages_age(m);
    (void)mind_leave(m);
}

mu_result mind_tell(struct mind *m, const char *fact)
{
    if (syntax_check(fact) || !MIND_ENTER(m, STATE_SENSE)) {
        return MU_MALFORMED;
    }
    const struct fact *told = EnvAssertString(m->env, fact);
    bool failed = mind_leave(m);
    return told && !failed ? MU_OK : MU_MALFORMED;
}

/* Searches from the slot behind the one that was found last. @return index of the slot, or -1 */
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

/* @return the asserted fact; NULL: there is no such slot, or the fact is there already */
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
    if (!MIND_ENTER(m, STATE_SENSE)) {
        return MU_MALFORMED;
    }
    struct deftemplate *t = EnvFindDeftemplate(m->env, relation);
    bool whole = t && !t->implied && slots_assert(m->env, t, slots, count) != NULL;
    bool failed = mind_leave(m);
    return whole && !failed ? MU_OK : MU_MALFORMED;
}

bool mind_looks_at(const struct mind *m, const char *relation)
{
    const struct deftemplate *t = state_has_rules(m) ? EnvFindDeftemplate(m->env, relation) : NULL;
    return t && fact_is_used(t);
}
