/* SPDX-License-Identifier: Apache-2.0 */
/*
 * Timers are facts of the library, (timer AT AGAIN WHAT...), so that they go wherever a mind goes.
 * Here they outlive (reset), and go on when another clock counts the steps.
 */
#include "mind/facts/facts.h"

/* @return the relation, if rules have not made another thing of the word; NULL: there is none */
static const struct deftemplate *timers_relation(const struct mind *m)
{
    const struct deftemplate *t = EnvFindDeftemplate(m->env, "timer");
    return t && t->implied ? t : NULL;
}

static const struct multifield *timers_fields(const struct fact *f)
{
    return f->theProposition.theFields[0].value;
}

/* Copies all timers into one multifield: of each the number of its fields, then these. */
static void timers_keep(struct mind *m)
{
    const struct deftemplate *t = timers_relation(m);
    const struct fact *f;
    long length = 0, at = 0;
    for (f = t ? t->factList : NULL; f; f = f->nextTemplateFact) {
        length += 1 + timers_fields(f)->multifieldLength;
    }
    struct multifield *kept = CreateMultifield2(m->env, length);
    for (f = t ? t->factList : NULL; f; f = f->nextTemplateFact) {
        const struct multifield *fields = timers_fields(f);
        kept->theFields[at].type = INTEGER;
        kept->theFields[at++].value = EnvAddLong(m->env, fields->multifieldLength);
        for (long i = 0; i < fields->multifieldLength; i++) {
            kept->theFields[at++] = fields->theFields[i];
        }
    }
    MultifieldInstall(m->env, kept);
    inputs_of(m)->timers = kept;
}

/* Asserts what was kept, so much later; the relation may have gone meanwhile. */
static void timers_set(struct mind *m, double later_s)
{
    struct multifield *kept = inputs_of(m)->timers;
    struct deftemplate *t = (struct deftemplate *)(uintptr_t)timers_relation(m);
    inputs_of(m)->timers = NULL;
    EnvIncrementGCLocks(m->env); /* no garbage collection before the fields stand in a fact */
    for (long at = 0; at < kept->multifieldLength && t;) {
        long length = (long)ValueToLong(kept->theFields[at].value);
        struct multifield *fields = CreateMultifield2(m->env, length);
        for (long i = 0; i < length; i++) {
            fields->theFields[i] = kept->theFields[at + 1 + i];
        }
        if (length > 0 && later_s != 0 && fields->theFields[0].type == FLOAT) {
            double due_s = ValueToDouble(fields->theFields[0].value) + later_s;
            value_set_float(m->env, fields, 0, due_s);
        }
        struct fact *f = fact_assert(m, t, fields);
        if (f) {
            EnvDecrementFactCount(m->env, f);
        }
        at += 1 + length;
    }
    EnvDecrementGCLocks(m->env);
    MultifieldDeinstall(m->env, kept);
    ReturnMultifield(m->env, kept);
}

static void timers_reset_begins(void *env)
{
    timers_keep(environment_mind(env));
}

static void timers_reset_ends(void *env)
{
    timers_set(environment_mind(env), 0);
}

void timers_install(struct mind *m)
{
    /* facts go at 60, deffacts come at 0 */
    EnvAddResetFunction(m->env, "mu-timers", timers_reset_begins, 100);
    EnvAddResetFunction(m->env, "mu-timers-again", timers_reset_ends, -10);
}

void timers_move(struct mind *m, double later_s)
{
    const struct deftemplate *t = timers_relation(m);
    bool gone = t && t->factList;
    if (!gone) {
        return;
    }
    timers_keep(m);
    while (t->factList && gone) {
        gone = EnvRetract(m->env, t->factList);
    }
    timers_set(m, later_s);
}
